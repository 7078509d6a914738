#include "datasets/io/trc_file.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/text.h"
#include "base/value_limits.h"
#include "datasets/io/cells.h"
#include "datasets/io/sample_times.h"
#include "datasets/io/text_file.h"
#include "datasets/units.h"

namespace sinew {
namespace {

constexpr std::size_t kColumnsBeforeMarkers = 2;  // frame number and time

class TrcParser {
 public:
  TrcParser(std::string_view text, const std::string& file) : lines_(text), file_(file) {}

  Result<TrcFile> Parse() {
    SINEW_TRY(ParseHeader());
    SINEW_TRY(ParseMarkerNames());
    SINEW_TRY(ParseAxes());
    SINEW_TRY(ParseFrames());
    SINEW_TRY(SetTimes());
    SetPositions();
    trc_.lines = std::move(printed_.lines);
    return std::move(trc_);
  }

 private:
  Result<std::string_view> NextLine(const char* expected) {
    std::string_view line;
    if (!lines_.Next(line))
      return Fail("{}: ends after line {}, expected {}", file_, lines_.number(), expected);
    return line;
  }

  Status ParseHeader() {
    SINEW_ASSIGN(const auto type, NextLine("a line that starts with PathFileType"));
    if (Lowercase(Trim(type).substr(0, 12)) != "pathfiletype") {
      return FailAt(file_, lines_.number(), "starts with {}, expected PathFileType: is it a .trc file?",
                    Quoted(Trim(type)));
    }
    SINEW_ASSIGN(const auto key_line, NextLine("DataRate, NumFrames, NumMarkers, Units"));
    SINEW_ASSIGN(const auto value_line, NextLine("the values of DataRate, NumFrames, NumMarkers, Units"));
    keys_ = SplitBlanks(key_line);
    values_ = SplitBlanks(value_line);
    header_line_ = lines_.number();

    SINEW_ASSIGN(const auto rate, HeaderValue("DataRate"));
    const auto rate_Hz = ParseNumber(rate);
    if (!rate_Hz || !(*rate_Hz > 0) || !std::isfinite(*rate_Hz)) {
      return FailAt(file_, header_line_, "DataRate is {}, expected a number above 0", Quoted(rate));
    }
    trc_.data_rate_Hz = *rate_Hz;
    SINEW_ASSIGN(frame_count_, HeaderCount("NumFrames"));
    SINEW_ASSIGN(marker_count_, HeaderCount("NumMarkers"));

    SINEW_ASSIGN(const auto units, HeaderValue("Units"));
    const auto conversion = ToSi(units);
    if (!conversion || conversion->si_unit != "m") {
      return FailAt(file_, header_line_, "Units is {}, expected m, cm or mm", Quoted(units));
    }
    metres_per_unit_ = conversion->factor;
    return {};
  }

  Result<std::string_view> HeaderValue(const std::string& key) const {
    const std::string wanted = Lowercase(key);
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      if (Lowercase(keys_[i]) != wanted) continue;
      if (i < values_.size()) return values_[i];
      return FailAt(file_, header_line_, "{} values for {} keys: {} has none", values_.size(), keys_.size(),
                    key);
    }
    return FailAt(file_, header_line_ - 1, "lacks {}, expected DataRate, NumFrames, NumMarkers and Units",
                  key);
  }

  Result<long> HeaderCount(const std::string& key) const {
    SINEW_ASSIGN(const auto text, HeaderValue(key));
    const auto count = ParseInteger(text);
    if (!count || *count < 1) {
      return FailAt(file_, header_line_, "{} is {}, expected a whole number above 0", key, Quoted(text));
    }
    return *count;
  }

  Status ParseMarkerNames() {
    SINEW_ASSIGN(const auto line, NextLine("the names of the markers"));
    const auto cells = line.find('\t') == std::string_view::npos ? SplitBlanks(line) : Split(line, '\t');
    if (cells.size() < kColumnsBeforeMarkers || Lowercase(Trim(cells[0]).substr(0, 5)) != "frame") {
      return FailAt(file_, lines_.number(), "expected Frame#, Time and the names of the markers");
    }
    if (cells.size() > kMostColumns)
      return FailAt(file_, lines_.number(), "has {} columns, expected at most {}", cells.size(),
                    kMostColumns);
    std::set<std::string> seen;
    for (std::size_t i = kColumnsBeforeMarkers; i < cells.size(); ++i) {
      const std::string name(Trim(cells[i]));
      if (name.empty()) continue;  // a name stands over the first of its three columns
      if (!seen.insert(name).second) {
        return FailAt(file_, lines_.number(), "the marker name {} appears twice", Quoted(name));
      }
      trc_.markers.push_back({name, {}});
    }
    if (static_cast<long>(trc_.markers.size()) != marker_count_) {
      return FailAt(file_, lines_.number(), "{} marker names, the header announces {} (NumMarkers, line {})",
                    trc_.markers.size(), marker_count_, header_line_);
    }
    return {};
  }

  Status ParseAxes() {
    SINEW_ASSIGN(const auto line, NextLine("the row X1 Y1 Z1 ..."));
    const std::string_view first = Trim(line).substr(0, 1);
    if (first != "X" && first != "x") {
      return FailAt(file_, lines_.number(), "starts with {}, expected the row X1 Y1 Z1 ...",
                    Quoted(Trim(line)));
    }
    return {};
  }

  Status ParseFrames() {
    int decimals = 0;
    std::string_view line;
    while (lines_.Next(line)) {
      if (Trim(line).empty()) continue;
      if (FrameCount() == frame_count_) {
        return FailAt(file_, lines_.number(),
                      "one frame more than the {} that the header announces (line {})", frame_count_,
                      header_line_);
      }
      SINEW_ASSIGN(const auto cells, SplitFrame(line));
      SINEW_TRY(ParseFrame(cells));
      decimals = std::max(decimals, DecimalPlaces(cells[1]));
    }
    if (FrameCount() == 0) return Fail("{}: has no frames", file_);
    if (FrameCount() < frame_count_) {
      trc_.notes.push_back(fmt::format(
          "{}:{}: the file ends after {} frames, the header announces {} (line {}); all of them were read",
          file_, lines_.number(), FrameCount(), frame_count_, header_line_));
    }
    constexpr int kMaxDecimals = 12;  // more digits than that: computed times, not rounded ones
    if (decimals <= kMaxDecimals) printed_.last_digit_s = std::pow(10.0, -decimals);
    return {};
  }

  [[nodiscard]] long FrameCount() const { return static_cast<long>(printed_.time_s.size()); }

  Result<std::vector<std::string_view>> SplitFrame(std::string_view line) const {
    const std::size_t expected = kColumnsBeforeMarkers + 3 * trc_.markers.size();
    auto cells = line.find('\t') == std::string_view::npos ? SplitBlanks(line) : Split(line, '\t');
    while (cells.size() > expected && Trim(cells.back()).empty()) cells.pop_back();
    if (cells.size() == expected) return cells;
    return FailAt(file_, lines_.number(),
                  "row has {} cells, expected {}: frame, time and 3 for each of {} markers", cells.size(),
                  expected, trc_.markers.size());
  }

  Status ParseFrame(const std::vector<std::string_view>& cells) {
    const auto frame = ParseInteger(cells[0]);
    if (!frame) {
      return FailAt(file_, lines_.number(), "the frame number is {}, expected a whole number",
                    Quoted(cells[0]));
    }
    printed_.sample_index.push_back(*frame);
    for (std::size_t i = 1; i < cells.size(); ++i) {
      const auto number = ParseSample(cells[i]);
      if (!number) {
        const std::string column =
            i == 1 ? "the time" : "marker '" + trc_.markers[(i - kColumnsBeforeMarkers) / 3].name + "'";
        return FailAt(file_, lines_.number(), "{}: {} is not a number", column, Quoted(cells[i]));
      }
      if (i == 1) {
        printed_.time_s.push_back(*number);
      } else {
        coordinates_.push_back(*number * metres_per_unit_);
      }
    }
    printed_.lines.push_back(lines_.number());
    return {};
  }

  Status SetTimes() {
    printed_.rate_Hz = trc_.data_rate_Hz;
    auto& frames = printed_.sample_index;
    // Frame numbers far apart are damage, not missing frames.
    constexpr long kLargestFrame = 1L << 40;
    bool usable = true;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      usable = usable && std::abs(frames[i]) < kLargestFrame && (i == 0 || frames[i] > frames[i - 1]);
    }
    if (!usable) frames.clear();
    SINEW_ASSIGN(trc_.time, UsableTimes(file_, printed_, trc_.notes));

    if (trc_.time.size() < 2) return {};
    const double steps = frames.empty() ? static_cast<double>(trc_.time.size() - 1)
                                        : static_cast<double>(frames.back() - frames.front());
    const double rate = steps / (trc_.time.back() - trc_.time.front());
    constexpr double kSameRate = 0.01;
    if (std::abs(rate / trc_.data_rate_Hz - 1) > kSameRate) {
      trc_.notes.push_back(
          fmt::format("{}: DataRate is {:.6g} Hz, but the times have {:.6g} Hz; the times were kept", file_,
                      trc_.data_rate_Hz, rate));
    }
    return {};
  }

  void SetPositions() {
    const auto markers = static_cast<Eigen::Index>(trc_.markers.size());
    const auto frames = static_cast<Eigen::Index>(trc_.time.size());
    for (Eigen::Index marker = 0; marker < markers; ++marker) {
      Matrix position(frames, 3);
      for (Eigen::Index frame = 0; frame < frames; ++frame) {
        for (Eigen::Index axis = 0; axis < 3; ++axis) {
          position(frame, axis) =
              coordinates_[static_cast<std::size_t>((frame * markers + marker) * 3 + axis)];
        }
      }
      trc_.markers[static_cast<std::size_t>(marker)].position = std::move(position);
    }
  }

  LineReader lines_;
  const std::string& file_;
  std::vector<std::string_view> keys_;
  std::vector<std::string_view> values_;
  long header_line_ = 0;
  long frame_count_ = 0;
  long marker_count_ = 0;
  double metres_per_unit_ = 1;
  PrintedTimes printed_;
  std::vector<double> coordinates_;  // [frame][marker][axis], m
  TrcFile trc_;
};

}  // namespace

Result<TrcFile> ParseTrc(std::string_view text, const std::string& file) {
  return TrcParser(text, file).Parse();
}

Result<TrcFile> ReadTrc(const std::string& path) {
  SINEW_ASSIGN(const std::string text, ReadTextFile(path));
  return ParseTrc(text, path);
}

}  // namespace sinew
