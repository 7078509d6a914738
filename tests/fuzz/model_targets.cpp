// Models: OpenSim's mechanisms and muscles, setups of inverse kinematics, meshes, reference curves.
#include <filesystem>

#include "models/contact/contact_mesh.h"
#include "models/mechanisms/mechanism_reference.h"
#include "models/multibody/ik_setup.h"
#include "models/multibody/multibody_model.h"
#include "models/multibody/muscle_geometry.h"
#include "models/multibody/osim_muscle_reader.h"
#include "models/multibody/osim_reader.h"
#include "tests/fuzz/targets.h"

namespace sinew::fuzz {
namespace {

void MoveMuscles(const std::string& text, const OsimModel& osim, const MultibodyModel& model) {
  const auto names = ListOsimMuscles(text, "m.osim");
  if (!Holds(names, "m.osim")) return;
  const auto muscles = ReadOsimMuscles(text, "m.osim", osim, *names);
  if (!Holds(muscles, "m.osim")) return;
  const auto geometry = MuscleGeometry::Build(model, *muscles);
  if (!Holds(geometry, "")) return;
  const Vector rates = Vector::Zero(model.default_values().size());
  const auto state = geometry->At(model.default_values(), rates, {});
  if (Holds(state, ""))
    Demand(static_cast<std::size_t>(state->lengths.size()) == muscles->size(), "a muscle has no length");
}

}  // namespace

void Osim(std::string_view bytes) {
  const std::string text(bytes);
  const auto osim = ReadOsim(text, "m.osim");
  if (!Holds(osim, "m.osim")) return;
  const auto model = MultibodyModel::Build(*osim);
  if (!Holds(model, "")) return;
  Demand(model->body_names().size() == osim->bodies.size() + 1, "bodies were lost");
  Demand(static_cast<std::size_t>(model->default_values().size()) == model->coordinate_names().size(),
         "a coordinate has no default");
  const auto markers = model->MarkerPositions(model->default_values());
  if (Holds(markers, "")) Demand(markers->size() == model->marker_names().size(), "markers were lost");
  MoveMuscles(text, *osim, *model);
}

void IkSetup(std::string_view bytes) {
  const auto setup = ReadIkSetup(bytes, "ik.xml");
  if (!Holds(setup, "ik.xml")) return;
  Demand(!setup->markers.empty() || !setup->coordinates.empty(), "no task");
  for (const auto& marker : setup->markers) Demand(marker.weight >= 0, "a weight");
  for (const auto& coordinate : setup->coordinates) Demand(coordinate.weight >= 0, "a weight");
}

void Obj(std::string_view bytes) {
  const auto mesh = ReadObj(std::string(bytes), "x.obj", 0.001);
  if (!Holds(mesh, "x.obj")) return;
  const auto vertices = static_cast<int>(mesh->vertices.size());
  for (const auto& face : mesh->faces) {
    for (const int corner : face) Demand(corner >= 0 && corner < vertices, "a face has no corner");
  }
}

void MechanismReference(std::string_view bytes) {
  const Mechanism& mechanism = MechanismRegistry().front();
  const std::string folder = ScratchFolder() + "/references";
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  for (const std::string& coordinate : mechanism.coordinates)
    Scratch("references/" + mechanism.name + "_reference_" + coordinate + ".csv", bytes);
  const auto reference = ReadReference(mechanism, folder);
  if (!Holds(reference, folder)) return;
  for (const ReferenceCurve& curve : reference->curves)
    Demand(!curve.time.empty() && curve.time.size() == curve.values.size(), "a curve's length");
}

}  // namespace sinew::fuzz
