// A can that rolls on its rim, in plain JavaScript: model in, trajectory out.
//
//   rockingcan export gentle-rock --format json --out scene.json
//   node rolling_can.mjs scene.json motion.csv 1e-5
//   rockingcan score gentle-rock motion.csv --name rolling_can.mjs --timestep 1e-5
//
// With r from the centre to the lowest point of the rim, which does not slip, the velocity of the
// centre is v = r x w, and the angular momentum about the centre changes by r x m (dv/dt - g):
//
//   (I + m (r.r - r r^T)) dw/dt = m r x (dr/dt x w - g) - w x I w
//
// stepped by the method of Runge and Kutta.
import { readFileSync, writeFileSync } from "node:fs";

const [source, target, step] = process.argv.slice(2);
const { scene, ends_s: ends } = JSON.parse(readFileSync(source, "utf8"));
const { mass, radius: R, H, A, C } = scene.can;
const { phi, psi = 0, theta = 0, phi_dot = 0, psi_dot = 0, theta_dot = 0 } = scene.release;
const gravity = [0, 0, -scene.gravity];

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const add = (a, b, s = 1) => a.map((x, i) => x + s * b[i]);
const scale = (a, s) => a.map((x) => s * x);
const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];

// the third column of the rotation of a quaternion (w, x, y, z): the axis of the can
const axisOf = ([w, x, y, z]) => [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)];

// r and dr/dt, from the axis u and its rate
function contact(u, rate) {
  const up = u[2], wide = Math.hypot(u[0], u[1]);
  const e = [(up * u[0]) / wide, (up * u[1]) / wide, -wide]; // down the base, of length 1
  const f = add(scale(rate, up), scale(u, rate[2]));
  const change = (u[0] * rate[0] + u[1] * rate[1]) / wide;
  const bent = [f[0] / wide - (e[0] * change) / wide, f[1] / wide - (e[1] * change) / wide, -change];
  return [add(scale(u, -H), e, R), add(scale(rate, -H), bent, R)];
}

// solution of a x = b, by Cramer's rule
function solve(a, b) {
  const columns = [0, 1, 2].map((j) => a.map((row) => row[j]));
  const det = (p, q, s) => dot(p, cross(q, s));
  const whole = det(...columns);
  return [0, 1, 2].map((j) => det(...columns.map((c, k) => (k === j ? b : c))) / whole);
}

// the rates of the state: position, quaternion, angular velocity in the world
function rates([p, q, w]) {
  const u = axisOf(q);
  const [r, turn] = contact(u, cross(w, u));
  const inertia = [0, 1, 2].map((i) =>
    [0, 1, 2].map((j) => (i === j ? A + mass * dot(r, r) : 0) + (C - A) * u[i] * u[j] - mass * r[i] * r[j]));
  const momentum = add(scale(w, A), scale(u, (C - A) * dot(w, u)));
  const moment = scale(cross(r, add(cross(turn, w), gravity, -1)), mass);
  const spun = [-dot(w, q.slice(1)), ...add(scale(w, q[0]), cross(w, q.slice(1)))];
  return [cross(r, w), scale(spun, 0.5), solve(inertia, add(moment, cross(w, momentum), -1))];
}

const advanced = (state, change, s) => state.map((part, i) => add(part, change[i], s));
function stepped(state, h) {
  const a = rates(state), b = rates(advanced(state, a, h / 2));
  const c = rates(advanced(state, b, h / 2)), d = rates(advanced(state, c, h));
  return state.map((part, i) =>
    part.map((x, j) => x + (h / 6) * (a[i][j] + 2 * b[i][j] + 2 * c[i][j] + d[i][j])));
}

// the release, in half angles: w + i z and x - i y of the quaternion have these sizes and phases
const [sum, difference] = [(psi + theta) / 2, (psi - theta) / 2];
const [upright, tilted] = [Math.cos(phi / 2), Math.sin(phi / 2)];
const inwards = theta_dot * Math.sin(phi);
let state = [
  [0, 0, R * Math.sin(phi) + H * Math.cos(phi)],
  [
    upright * Math.cos(sum), tilted * Math.sin(difference),
    -tilted * Math.cos(difference), upright * Math.sin(sum),
  ],
  [
    phi_dot * Math.sin(psi) - inwards * Math.cos(psi),
    -phi_dot * Math.cos(psi) - inwards * Math.sin(psi),
    psi_dot + theta_dot * Math.cos(phi),
  ],
];

const names = ["time_s", "x_m", "y_m", "z_m", "qw", "qx", "qy", "qz", "vx_m_s", "vy_m_s", "vz_m_s",
  "wx_rad_s", "wy_rad_s", "wz_rad_s"];
const lines = [names.join(",")];
// a little longer, so that the maximum with which the bounce ends is in the record
const h = Number(step), steps = Math.ceil((1.02 * ends) / h), every = Math.max(1, Math.round(1e-4 / h));
for (let n = 0; n <= steps; n++) {
  const [p, q, w] = state;
  if (n % every === 0 || n === steps) lines.push([n * h, ...p, ...q, ...rates(state)[0], ...w].join(","));
  state = stepped(state, h);
  state[1] = scale(state[1], 1 / Math.hypot(...state[1]));
}
writeFileSync(target, lines.join("\n") + "\n");
