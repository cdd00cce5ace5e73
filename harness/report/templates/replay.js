// Plays the replays: cans and the curves of their contact points, drawn in slanted projection.
(() => {
  "use strict";
  const kinds = JSON.parse(document.getElementById("kinds").textContent);
  const value = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const still = matchMedia("(prefers-reduced-motion: reduce)");
  const RATE = 60; // frames a second
  const STEP = 12; // frames at a press, for readers who want no motion
  const SLANT = 0.5, TURN = -0.6; // of the view: above the plane, and about the vertical, rad
  const STEPS = 48; // sides of the polygon that stands for a rim

  function unpack({ dtype, bdata, low, step }) {
    const bytes = Uint8Array.from(atob(bdata), (c) => c.charCodeAt(0));
    if (dtype === "u2") return Float64Array.from(new Uint16Array(bytes.buffer), (n) => low + step * n);
    return new (dtype === "f8" ? Float64Array : Float32Array)(bytes.buffer);
  }

  // From the world, in radii, to the plane of the picture: right, up.
  const cosTurn = Math.cos(TURN), sinTurn = Math.sin(TURN), cosSlant = Math.cos(SLANT), sinSlant = Math.sin(SLANT);
  const seen = ([x, y, z]) => [x * cosTurn - y * sinTurn, z * cosSlant + (x * sinTurn + y * cosTurn) * sinSlant];
  const plus = (a, b, s = 1) => a.map((one, n) => one + s * b[n]);

  // Where a can is: middle of its bottom, its axis, the two directions that span a rim, its mark.
  function pose(body, frame, tilt, height) {
    const [phi, psi, theta] = [tilt * body.phi[frame], body.psi[frame], body.theta[frame]];
    const down = [-Math.cos(phi) * Math.cos(psi), -Math.cos(phi) * Math.sin(psi), -Math.sin(phi)];
    const across = [-Math.sin(psi), Math.cos(psi), 0];
    const axis = [-Math.sin(phi) * Math.cos(psi), -Math.sin(phi) * Math.sin(psi), Math.cos(phi)];
    const bottom = plus([body.x[frame], body.y[frame], body.z ? body.z[frame] : 0], down, -1);
    const mark = plus(down.map((one) => -Math.cos(theta) * one), across, Math.sin(theta));
    return { bottom, top: plus(bottom, axis, height), axis, down, across, mark };
  }

  function rim(centre, at) {
    return Array.from({ length: STEPS + 1 }, (_, n) => {
      const angle = (2 * Math.PI * n) / STEPS;
      return seen(plus(plus(centre, at.down, Math.cos(angle)), at.across, Math.sin(angle)));
    });
  }

  // The two lines that bound the side of a cylinder: where the rim runs along the axis.
  function sides(at) {
    const cross = (a, b) => a[0] * b[1] - a[1] * b[0];
    const axis = seen(at.axis), first = seen(at.down), second = seen(at.across);
    const angle = Math.atan2(cross(axis, second), cross(axis, first));
    return [0, Math.PI].map((half) => {
      const out = plus(at.down.map((one) => one * Math.cos(angle + half)), at.across, Math.sin(angle + half));
      return [seen(plus(at.bottom, out)), seen(plus(at.top, out))];
    });
  }

  async function read(element) {
    const told = JSON.parse(await unpacked(element.querySelector(".frames")));
    const bodies = told.bodies.map((one) => ({
      ...one,
      ...Object.fromEntries(["phi", "psi", "theta", "x", "y", ...(one.z ? ["z"] : [])].map((name) => [name, unpack(one[name])])),
    }));
    const own = bodies[0];
    const around = { low: [Infinity, Infinity], high: [-Infinity, -Infinity] };
    for (let frame = 0; frame < own.x.length; frame += 8) {
      const at = pose(own, frame, told.tilt, told.height);
      for (const [x, y] of [...rim(at.bottom, at), ...rim(at.top, at), seen([own.x[frame], own.y[frame], 0])]) {
        around.low = [Math.min(around.low[0], x), Math.min(around.low[1], y)];
        around.high = [Math.max(around.high[0], x), Math.max(around.high[1], y)];
      }
    }
    return { ...told, bodies, around, time: unpack(told.time) };
  }

  function paint(canvas, replay, number, frame) {
    const size = canvas.clientWidth, sharp = devicePixelRatio || 1;
    if (!size) return;
    canvas.width = canvas.height = Math.round(size * sharp);
    const pen = canvas.getContext("2d");
    const body = replay.bodies[number], { low, high } = replay.around;
    const scale = (0.9 * size) / Math.max(high[0] - low[0], high[1] - low[1]);
    const place = ([x, y]) => [
      size / 2 + scale * (x - (low[0] + high[0]) / 2),
      size / 2 - scale * (y - (low[1] + high[1]) / 2),
    ];
    const line = (points, colour, width, dash = []) => {
      pen.beginPath();
      points.forEach((point, n) => pen[n ? "lineTo" : "moveTo"](...place(point)));
      pen.strokeStyle = colour; pen.lineWidth = width; pen.setLineDash(dash);
      pen.stroke();
    };
    const own = value(kinds[body.kind]), ink = value("--ink"), soft = value("--soft"), card = value("--card");
    const curve = (one, until) => Array.from({ length: until + 1 }, (_, n) => seen([one.x[n], one.y[n], 0]));
    pen.setTransform(sharp, 0, 0, sharp, 0, 0);
    pen.lineJoin = "round"; pen.lineCap = "round";
    line(curve(replay.bodies[0], replay.time.length - 1), soft, 1, [2, 4]); // where the exact can goes
    line(curve(body, frame), own, 2.4);

    const at = pose(body, frame, replay.tilt, replay.height);
    const [left, right] = sides(at);
    const bottom = rim(at.bottom, at), top = rim(at.top, at);
    pen.beginPath();
    for (const outline of [bottom, top, [left[0], left[1], right[1], right[0]]]) {
      outline.forEach((point, n) => pen[n ? "lineTo" : "moveTo"](...place(point)));
      pen.closePath();
    }
    pen.fillStyle = card; pen.globalAlpha = 0.72; pen.fill("nonzero"); pen.globalAlpha = 1;
    line(bottom, soft, 1);
    line(left, ink, 1.6);
    line(right, ink, 1.6);
    line(top, ink, 1.6);
    line([seen(at.top), seen(plus(at.top, at.mark))], own, 2.6); // turns with the can
    pen.beginPath();
    pen.arc(...place(seen([body.x[frame], body.y[frame], 0])), 4, 0, 2 * Math.PI);
    pen.fillStyle = own; pen.fill();
  }

  const UNITS = [["s", 1], ["ms", 1e-3], ["µs", 1e-6], ["ns", 1e-9]];
  function duration(seconds, digits) {
    const [unit, size] = UNITS.find(([, one]) => Math.abs(seconds) >= one) ?? UNITS.at(-1);
    return `${(seconds / size).toPrecision(digits)} ${unit}`;
  }

  function start(element) {
    const slider = element.querySelector("input"), clock = element.querySelector(".clock");
    const play = element.querySelector(".play"), pace = element.querySelector("select");
    const canvases = [...element.querySelectorAll("canvas")];
    const controls = element.querySelectorAll("button, input, select");
    controls.forEach((control) => { control.disabled = true; }); // until there is something to play
    let replay, frame = 0, playing = false, before = 0;

    function show() {
      const whole = Math.round(frame), { time } = replay;
      canvases.forEach((canvas, number) => paint(canvas, replay, number, whole));
      const near = time[Math.min(whole + 1, time.length - 1)] - time[Math.max(whole - 1, 0)];
      const step = near / (Math.min(whole + 1, time.length - 1) - Math.max(whole - 1, 0));
      slider.value = whole;
      slider.setAttribute("aria-valuetext", `${(1e3 * time[whole]).toPrecision(6)} milliseconds`);
      const told = `${(1e3 * time[whole]).toPrecision(7)} ms; a second of watching shows ${duration(step * RATE * pace.value, 2)}`;
      if (!playing) clock.textContent = told; // read aloud only when it stands
      else clock.firstChild ? (clock.firstChild.data = told) : (clock.textContent = told);
    }
    function stop() {
      playing = false;
      label();
      clock.setAttribute("role", "status");
    }
    function label() {
      play.textContent = still.matches ? "Step" : playing ? "Pause" : "Play";
    }
    function run(now) {
      if (!playing) return;
      frame += (Math.min(now - before, 100) / 1000) * RATE * pace.value;
      before = now;
      const last = replay.time.length - 1;
      if (frame >= last) { frame = last; stop(); }
      show();
      if (playing) requestAnimationFrame(run);
    }
    play.addEventListener("click", () => {
      const last = replay.time.length - 1;
      if (frame >= last) frame = 0;
      if (still.matches) {
        frame = Math.min(frame + STEP, last);
        show();
        return;
      }
      if (playing) { stop(); show(); return; }
      playing = true;
      label();
      clock.removeAttribute("role");
      before = performance.now();
      requestAnimationFrame(run);
    });
    slider.addEventListener("input", () => { stop(); frame = Number(slider.value); show(); });
    pace.addEventListener("change", show);
    element.querySelector(".to-bounce").addEventListener("click", () => {
      const phi = replay.bodies[0].phi;
      stop();
      frame = phi.indexOf(Math.min(...phi));
      show();
    });
    still.addEventListener("change", () => { stop(); });
    let opened = false;
    return {
      async open() {
        if (opened) return;
        opened = true;
        replay = await read(element);
        controls.forEach((control) => { control.disabled = false; });
        label();
        show();
        new ResizeObserver(show).observe(element.querySelector(".stage"));
        matchMedia("(prefers-color-scheme: dark)").addEventListener("change", show);
      },
    };
  }

  const replays = new Map([...document.querySelectorAll(".replay")].map((element) => [element, start(element)]));
  const watcher = new IntersectionObserver(
    (seenNow) => seenNow.filter((one) => one.isIntersecting).forEach((one) => replays.get(one.target).open()),
    { rootMargin: "300px" },
  );
  replays.forEach((_, element) => watcher.observe(element));
})();
