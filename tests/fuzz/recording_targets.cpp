// Recordings and what describes them, as `sinew data import` reads them.
#include <cmath>

#include "datasets/io/csv_file.h"
#include "datasets/io/external_loads.h"
#include "datasets/io/import.h"
#include "datasets/io/import_map.h"
#include "datasets/io/mat_path.h"
#include "datasets/io/plates.h"
#include "datasets/io/storage_file.h"
#include "datasets/io/trc_file.h"
#include "datasets/units.h"
#include "tests/fuzz/targets.h"

namespace sinew::fuzz {
namespace {

void DemandIncreasing(const std::vector<double>& time) {
  for (std::size_t i = 0; i < time.size(); ++i) {
    Demand(std::isfinite(time[i]), "a time is not finite");
    Demand(i == 0 || time[i - 1] < time[i], "times do not increase");
  }
}

}  // namespace

void Trc(std::string_view bytes) {
  const auto trc = ParseTrc(bytes, "x.trc");
  if (!Holds(trc, "x.trc")) return;
  DemandIncreasing(trc->time);
  for (const auto& marker : trc->markers)
    Demand(static_cast<std::size_t>(marker.position.rows()) == trc->time.size(), "a marker's length");
}

void Storage(std::string_view bytes) {
  const auto storage = ParseStorage(bytes, "x.mot");
  if (!Holds(storage, "x.mot")) return;
  DemandIncreasing(storage->time);
  Demand(storage->names.size() == storage->columns.size(), "names and columns");
  for (const auto& column : storage->columns)
    Demand(column.size() == storage->time.size(), "a column's length");
}

void Csv(std::string_view bytes) {
  const auto table = ParseCsv(bytes, "x.csv");
  if (!Holds(table, "x.csv")) return;
  for (const CsvColumn& column : table->columns)
    Demand(column.values.size() == table->lines.size(), "a column's length");
}

void CsvImport(std::string_view bytes) {
  const std::vector<std::string> parts = Parts(bytes, 2);
  auto map = ParseImportMap(parts[0], "map.yaml");
  if (!Holds(map, "map.yaml")) return;
  ImportOptions options;
  options.map = std::move(*map);
  const std::string path = Scratch("table.csv", parts[1]);
  Dataset data;
  std::vector<std::string> notes;
  const Status imported = ImportFile(path, options, data, notes);
  if (imported) {
    Demand(data.Check().has_value(), "an imported data set is none");
    for (const auto& [name, grid] : data.trials.begin()->second.grids) DemandIncreasing(grid.time);
  } else {
    Demand(!imported.error().message.empty(), "an error without words");
    Demand(data.trials.empty() && data.constants.empty(), "a refused file changed the data set");
  }
}

void ImportMap(std::string_view bytes) {
  const auto map = ParseImportMap(bytes, "map.yaml");
  if (!Holds(map, "map.yaml")) return;
  for (const auto& [name, channel] : map->channels) {
    Demand(std::isfinite(channel.scale) && channel.scale != 0, "a scale");
    Demand(!channel.sigma || *channel.sigma > 0, "a sigma");
  }
}

void ExternalLoads(std::string_view bytes) {
  const auto forces = ParseExternalLoads(bytes, "x.xml");
  if (!Holds(forces, "x.xml")) return;
  Demand(!forces->empty(), "no force");
  for (const ExternalForce& force : *forces)
    Demand(!force.force_identifier.empty(), "a force without columns");
}

void Units(std::string_view bytes) {
  const std::string text(bytes);
  const auto unit = ToSi(text);
  if (unit) {
    Demand(std::isfinite(unit->factor) && unit->factor != 0, "a factor");
    const auto again = ToSi(unit->si_unit);
    Demand(again && again->factor == 1, "an SI unit is not one");
  }
  const auto plates = ParsePlates(text);
  Demand(plates || !plates.error().message.empty(), "an error without words");
  const auto path = ParseMatPath(text);
  if (path) Demand(!path->variable.empty(), "a path without a variable");
}

}  // namespace sinew::fuzz
