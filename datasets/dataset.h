// Measured data: trials, each with channels on one or more time grids.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"

namespace sinew {

/// Train: parameters are fitted to it. Validate: only ever predicted.
enum class Role { kTrain, kValidate };

/// Measured: something a model predicts. Input: something a model is given.
enum class ChannelKind { kMeasured, kInput };

/// One signal: a value per sample of its grid, SI units, NaN where there is a gap.
struct Channel {
  std::string unit;
  ChannelKind kind = ChannelKind::kMeasured;
  std::optional<double> sigma;  ///< standard deviation of its noise, in its unit, > 0, if known
  std::vector<double> values;
};

/// Channels that were sampled together.
struct Grid {
  std::vector<double> time;  ///< [N, s, strictly increasing]
  std::map<std::string, Channel> channels;
};

struct Trial {
  Role role = Role::kTrain;
  std::string task;
  std::string cut_from;  ///< name of the recording that it is a part of, with its times; empty: a recording
  std::map<std::string, double> conditions;  ///< such as speed_rad_per_s
  std::map<std::string, Grid> grids;

  /// A channel and its grid; both nullptr if no grid has it. If several grids have a channel of that name,
  /// the first by name of the grid.
  struct Found {
    const Grid* grid = nullptr;
    const Channel* channel = nullptr;
    explicit operator bool() const { return channel != nullptr; }
  };
  [[nodiscard]] Found Find(const std::string& channel) const;
  [[nodiscard]] std::vector<std::string> ChannelNames() const;
};

struct Constant {
  double value = 0;
  std::string unit;
};

struct Dataset {
  std::string title;
  std::string subject;
  std::string source;
  std::string licence;
  bool synthetic = false;
  std::map<std::string, Trial> trials;
  std::map<std::string, Constant> constants;
  std::map<std::string, std::string> files;  ///< texts that belong to the trials, such as an .osim

  /// Checks the invariants that all readers and writers rely on: sizes agree, time increases strictly and is
  /// finite, sigma > 0, units are known, names are not empty and contain no '/'. The error names the trial,
  /// grid and channel.
  [[nodiscard]] Status Check() const;
};

}  // namespace sinew
