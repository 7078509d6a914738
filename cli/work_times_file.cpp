#include "cli/work_times_file.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/replace_file.h"
#include "cli/mpi_ranks.h"

namespace sinew {

WorkTimesFile::WorkTimesFile(std::string path) : path_(std::move(path)) {}

SharedWork WorkTimesFile::work() {
  return {TheRanks(), path_.empty() ? nullptr : &times_};
}

Status WorkTimesFile::Write() const {
  if (path_.empty()) return {};
  using Json = nlohmann::ordered_json;
  Json json{{"schema", "sinew.work_times/1"}, {"processor_seconds", WorkTimes::OfProcess()}};
  json["loops"] = Json::array();
  for (const WorkTimes::Loop& loop : times_.loops()) {
    Json pieces = Json::array();
    for (const double seconds : loop.pieces) pieces.push_back(std::isnan(seconds) ? Json() : Json(seconds));
    json["loops"].push_back({{"pieces", std::move(pieces)},
                             {"processor_seconds", loop.ended - loop.began},
                             {"repeated", loop.repeated}});
  }
  return ReplaceFile(path_, json.dump() + "\n");
}

}  // namespace sinew
