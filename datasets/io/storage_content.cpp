#include "datasets/io/storage_content.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "base/text.h"

namespace sinew {
namespace {

constexpr double kRadPerDeg = 3.14159265358979323846 / 180;
constexpr std::string_view kSpeedSuffix = "_speed";

bool Contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

bool EndsWith(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

// Ends with `end` and one of x, y, z: "_t" for pelvis_tx.
bool EndsWithAxis(std::string_view text, std::string_view end) {
  if (text.empty() || !Contains("xyz", text.substr(text.size() - 1))) return false;
  return EndsWith(text.substr(0, text.size() - 1), end);
}

bool IsGeneralizedForce(std::string_view name) {
  return EndsWith(name, "_moment") || EndsWith(name, "_force");
}

bool IsPlateForce(const std::string& name) {
  const std::string lower = Lowercase(name);
  return (Contains(lower, "force") || Contains(lower, "grf")) && EndsWithAxis(lower, "v");
}

std::string WithoutSpeed(const std::string& name) {
  return EndsWith(name, kSpeedSuffix) ? name.substr(0, name.size() - kSpeedSuffix.size()) : name;
}

bool LooksLikeCoordinate(const std::string& column, const CoordinateKindOf& kind_of) {
  const std::string name = WithoutSpeed(ChannelName(column));
  if (kind_of && kind_of(name)) return true;
  constexpr std::array<std::string_view, 12> kWords = {"_angle",    "_flexion", "_extension", "_adduction",
                                                       "_rotation", "_tilt",    "_list",      "_bending",
                                                       "_tx",       "_ty",      "_tz",        "_obliquity"};
  return std::any_of(kWords.begin(), kWords.end(),
                     [&](std::string_view word) { return Contains(name, word); });
}

bool IsTranslationalByName(const std::string& name) {
  return EndsWithAxis(name, "_t") || Contains(name, "_force") || EndsWithAxis(name, "_f");
}

CoordinateKind KindOf(const std::string& coordinate, const CoordinateKindOf& kind_of) {
  if (const auto known = kind_of ? kind_of(coordinate) : std::nullopt) return *known;
  if (IsTranslationalByName(coordinate)) return CoordinateKind::kLength;
  return EndsWith(coordinate, "_beta") ? CoordinateKind::kCoupledAngle : CoordinateKind::kAngle;
}

ColumnMeaning CoordinateMeaning(const std::string& column, bool in_degrees, const CoordinateKindOf& kind_of) {
  const std::string channel = ChannelName(column);
  const std::string coordinate = WithoutSpeed(channel);
  const CoordinateKind kind = KindOf(coordinate, kind_of);
  ColumnMeaning meaning{channel, kind == CoordinateKind::kLength ? "m" : "rad", ChannelKind::kInput};
  if (coordinate != channel) meaning.unit += "/s";
  if (kind == CoordinateKind::kAngle && in_degrees) meaning.factor = kRadPerDeg;
  return meaning;
}

// Without `inDegrees` OpenSim takes radians; but tables of moments may name their columns after coordinates.
bool MayBeRadians(const Storage& storage, const std::string& names, const CoordinateKindOf& kind_of) {
  constexpr std::array<std::string_view, 7> kNoAngles = {"moment", "torque",   "dynamics",    "force",
                                                         "load",   "velocity", "acceleration"};
  if (std::any_of(kNoAngles.begin(), kNoAngles.end(),
                  [&](std::string_view word) { return Contains(names, word); }))
    return false;
  constexpr double kTwoTurns = 8 * 1.5707963267948966;
  for (std::size_t i = 0; i < storage.names.size(); ++i) {
    const std::string channel = ChannelName(storage.names[i]);
    if (WithoutSpeed(channel) != channel || KindOf(channel, kind_of) != CoordinateKind::kAngle) continue;
    for (const double value : storage.columns[i]) {
      if (std::abs(value) > kTwoTurns) return false;
    }
  }
  return true;
}

ColumnMeaning PlateMeaning(const std::string& column) {
  const std::string lower = Lowercase(column);
  if (Contains(lower, "torque") || Contains(lower, "moment")) return {column, "N*m"};
  if (EndsWithAxis(lower, "v") || EndsWithAxis(lower, "_f")) return {column, "N"};
  if (EndsWithAxis(lower, "p")) return {column, "m"};
  return {column, "1", ChannelKind::kMeasured, 1, false};
}

ColumnMeaning OtherMeaning(const std::string& column) {
  const std::string channel = ChannelName(column);
  if (EndsWith(channel, "_moment")) return {channel, "N*m"};
  if (EndsWith(channel, "_force")) return {channel, "N"};
  if (EndsWith(channel, "_length")) return {channel, "m"};
  return {channel, "1", ChannelKind::kMeasured, 1, EndsWith(channel, "_activation")};
}

}  // namespace

StorageContent ClassifyStorage(const Storage& storage, const std::string& stem,
                               const CoordinateKindOf& kind_of) {
  const auto count = [&](auto predicate) {
    return std::count_if(storage.names.begin(), storage.names.end(), predicate);
  };
  if (count(IsPlateForce) >= 3) return StorageContent::kForces;

  const std::string title = Lowercase(storage.title);
  const std::string names = title + " " + Lowercase(stem);
  if (Contains(names, "emg") || Contains(names, "excitation")) return StorageContent::kExcitations;
  if (Contains(names, "momentarm") || Contains(names, "moment_arm")) return StorageContent::kMomentArms;
  if (title.substr(0, 6) == "length") return StorageContent::kMuscleLengths;

  const auto coordinates = count([&](const auto& name) { return LooksLikeCoordinate(name, kind_of); });
  const bool mostly_coordinates = 2 * static_cast<std::size_t>(coordinates) >= storage.names.size();
  const bool says_angles =
      count(IsGeneralizedForce) == 0 &&
      (storage.in_degrees.has_value() || (coordinates > 0 && (title == "coordinates" || mostly_coordinates) &&
                                          MayBeRadians(storage, names, kind_of)));
  if (says_angles && coordinates > 0 && (title == "coordinates" || mostly_coordinates)) {
    return StorageContent::kCoordinates;
  }
  return StorageContent::kOther;
}

ColumnMeaning MeaningOf(const std::string& column, StorageContent content, bool in_degrees,
                        const CoordinateKindOf& kind_of) {
  switch (content) {
    case StorageContent::kCoordinates:
      if (column.rfind("/forceset/", 0) == 0) return OtherMeaning(column);
      return CoordinateMeaning(column, in_degrees, kind_of);
    case StorageContent::kForces:
      return PlateMeaning(column);
    case StorageContent::kExcitations:
      return {ChannelName(column), "1", ChannelKind::kInput};
    case StorageContent::kMuscleLengths:
    case StorageContent::kMomentArms:
      return {ChannelName(column), "m", ChannelKind::kInput};
    case StorageContent::kOther:
      break;
  }
  return OtherMeaning(column);
}

std::string ChannelName(const std::string& column) {
  if (column.find_first_of("/|") == std::string::npos) return column;
  constexpr std::size_t kStatePath = 3;  // set/owner/state, and a joint before it for coordinates
  std::vector<std::string_view> parts;
  for (const std::string_view part : Split(column, '/')) {
    if (!part.empty()) parts.push_back(part);
  }
  if (parts.empty()) return "_";
  std::string name(parts.back());
  const bool is_state = parts.size() >= kStatePath && !Contains(name, "|");
  if (is_state && name == "value") {
    name = parts[parts.size() - 2];
  } else if (is_state) {
    name = std::string(parts[parts.size() - 2]) + "_" + name;
  }
  std::replace(name.begin(), name.end(), '|', '_');
  return name;
}

}  // namespace sinew
