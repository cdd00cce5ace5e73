// A can that rolls on its rim in MuJoCo's C API: model in, trajectory out.
//
//   rockingcan export gentle-rock --format mjcf --out can.xml
//   g++ -std=c++17 -I$MUJOCO/include mujoco_can.cc $MUJOCO/libmujoco.so.* -Wl,-rpath,$MUJOCO -o mujoco_can
//   ./mujoco_can can.xml motion.csv 1e-5 0.34
//   rockingcan score gentle-rock motion.csv --name mujoco-c --timestep 1e-5
//
// where MUJOCO is the folder of the library, such as that of Python's package `mujoco`. The contact
// is made as stiff as the timestep lets it be, its cone elliptic, and friction hard.
#include <mujoco/mujoco.h>

#include <cstdio>
#include <cstdlib>

int main(int argc, char** argv) {
  if (argc != 5) return std::fprintf(stderr, "usage: mujoco_can MODEL MOTION TIMESTEP SECONDS\n"), 2;
  char error[1000] = "";
  mjModel* model = mj_loadXML(argv[1], nullptr, error, sizeof error);
  if (!model) return std::fprintf(stderr, "%s\n", error), 2;
  const double step = std::atof(argv[3]), seconds = std::atof(argv[4]);
  model->opt.timestep = step;
  model->opt.cone = mjCONE_ELLIPTIC;
  model->opt.impratio = 100;
  model->opt.tolerance = 1e-12;
  for (int geom = 0; geom < model->ngeom; geom++) {
    model->geom_solref[mjNREF * geom] = 2 * step;
    model->geom_solimp[mjNIMP * geom + 1] = 0.9;
  }
  mjData* data = mj_makeData(model);
  mj_resetDataKeyframe(model, data, mj_name2id(model, mjOBJ_KEY, "release"));
  std::FILE* out = std::fopen(argv[2], "w");
  if (!out) return std::perror(argv[2]), 2;
  std::fprintf(out, "time_s,x_m,y_m,z_m,qw,qx,qy,qz,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s\n");
  const int every = step < 1e-4 ? static_cast<int>(1e-4 / step + 0.5) : 1;
  for (int n = 0; data->time < seconds; n++) {
    if (n % every == 0) {
      const mjtNum *q = data->qpos, *v = data->qvel;
      mjtNum spin[3];  // of a free joint in the axes of the body
      mju_rotVecQuat(spin, v + 3, q + 3);
      std::fprintf(out, "%.17g", data->time);
      for (int i = 0; i < 7; i++) std::fprintf(out, ",%.17g", q[i]);
      for (int i = 0; i < 3; i++) std::fprintf(out, ",%.17g", v[i]);
      for (int i = 0; i < 3; i++) std::fprintf(out, ",%.17g", spin[i]);
      std::fprintf(out, "\n");
    }
    mj_step(model, data);
  }
  std::fclose(out);
  mj_deleteData(data);
  mj_deleteModel(model);
  return 0;
}
