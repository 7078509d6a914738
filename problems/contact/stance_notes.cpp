#include "problems/contact/stance_notes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "base/constants.h"
#include "base/text.h"

namespace sinew {
namespace {

constexpr std::size_t kMostAlone = 3;  // stances that have a sentence each
constexpr double kWorthSaying = 5e-4;  // [m]

std::string Several(const std::vector<std::string>& names) {
  if (names.size() <= kMostAlone) return Join(names, "; ");
  const std::vector<std::string> first(names.begin(), names.begin() + kMostAlone);
  return fmt::format("{} and {} more", Join(first, "; "), names.size() - kMostAlone);
}

// "1.1 to 4.2".
template <typename List, typename Value>
std::string FromTo(const List& list, Value value) {
  const auto [least, most] = std::minmax_element(
      list.begin(), list.end(), [&](const auto& a, const auto& b) { return value(a) < value(b); });
  return fmt::format("{:.1f} to {:.1f}", value(*least), value(*most));
}

}  // namespace

std::string StanceNotes::Where::Words() const {
  return fmt::format("trial '{}', {}", trial, plate);
}

void StanceNotes::Say(std::vector<Said>& list, const std::string& what, std::string of) {
  const auto found =
      std::find_if(list.begin(), list.end(), [&](const Said& one) { return one.what == what; });
  if (found == list.end())
    list.push_back({what, {std::move(of)}});
  else
    found->of.push_back(std::move(of));
}

void StanceNotes::Held(const std::string& trial, const std::vector<std::string>& coordinates) {
  if (coordinates.empty()) return;
  Say(held_, fmt::format("no data for {}: held at the model's default", Join(coordinates, ", ")),
      fmt::format("trial '{}'", trial));
}

void StanceNotes::MovedToMarkers(const Stance& stance, const MarkerPose& pose) {
  if (!stance.markers.markers.empty())
    poses_.push_back({{stance.trial, stance.plate}, stance.markers.markers.size(), pose});
}

void StanceNotes::Raised(const Stance& stance, double height) {
  if (std::abs(height) >= kWorthSaying) heights_.push_back({{stance.trial, stance.plate}, height});
}

void StanceNotes::NotCompared(const Stance& stance, const std::string& channel, std::size_t missing,
                              std::size_t recorded) {
  if (missing > 0) missing_.push_back({stance.trial, channel, missing, recorded});
}

void StanceNotes::NoBodyLoad(const Stance& stance, const std::string& why) {
  Say(no_load_, "the whole body's load is not used: " + why, Where{stance.trial, stance.plate}.Words());
}

void StanceNotes::AddPoses(std::vector<std::string>& sentences) const {
  constexpr double kDegrees = 180 / kPi;
  if (poses_.size() <= kMostAlone) {
    for (const auto& [where, markers, pose] : poses_) {
      sentences.push_back(fmt::format(
          "{}: the {} markers on the foot lie {:.1f} mm from the recorded motion, {:.1f} mm from the foot's "
          "own, which differs from it by {:.1f} mm and {:.1f} degrees (root mean squares); their noise from "
          "frame to frame is {:.2g} mm",
          where.Words(), markers, 1e3 * pose.residual_recorded, 1e3 * pose.residual, 1e3 * pose.shift,
          kDegrees * pose.turn, 1e3 * pose.noise.marker));
    }
    return;
  }
  const auto noisiest = std::max_element(poses_.begin(), poses_.end(), [](const Pose& a, const Pose& b) {
    return a.pose.noise.marker < b.pose.noise.marker;
  });
  const auto farthest = std::max_element(poses_.begin(), poses_.end(), [](const Pose& a, const Pose& b) {
    return a.pose.residual_recorded < b.pose.residual_recorded;
  });
  sentences.push_back(fmt::format(
      "in {} stances the markers on the foot lie {} mm from the recorded motion (most in {}), {} mm from the "
      "foot's own, which differs from it by {} mm and {} degrees (root mean squares); their noise from frame "
      "to frame is {:.2g} mm at most",
      poses_.size(), FromTo(poses_, [](const Pose& one) { return 1e3 * one.pose.residual_recorded; }),
      farthest->where.Words(), FromTo(poses_, [](const Pose& one) { return 1e3 * one.pose.residual; }),
      FromTo(poses_, [](const Pose& one) { return 1e3 * one.pose.shift; }),
      FromTo(poses_, [](const Pose& one) { return kDegrees * one.pose.turn; }),
      1e3 * noisiest->pose.noise.marker));
}

void StanceNotes::AddHeights(std::vector<std::string>& sentences) const {
  if (heights_.size() <= kMostAlone) {
    for (const auto& [where, raised] : heights_) {
      sentences.push_back(fmt::format(
          "{}: the recorded motion was {} by {:.1f} mm, so that the flat foot is as high as in the "
          "fitted stances",
          where.Words(), raised > 0 ? "raised" : "lowered", 1e3 * std::abs(raised)));
    }
    return;
  }
  const auto most = std::max_element(heights_.begin(), heights_.end(), [](const Height& a, const Height& b) {
    return std::abs(a.raised) < std::abs(b.raised);
  });
  sentences.push_back(fmt::format(
      "the recorded motion of {} stances was raised or lowered, by {} mm (most in {}: {}), so that flat feet "
      "are "
      "as high as in the fitted stances",
      heights_.size(), FromTo(heights_, [](const Height& one) { return 1e3 * std::abs(one.raised); }),
      most->where.Words(), most->raised > 0 ? "raised" : "lowered"));
}

void StanceNotes::AddMissing(std::vector<std::string>& sentences) const {
  constexpr const char* kWhy = "(gaps, no motion there, or a light foot)";
  std::set<std::string> trials;
  for (const Missing& one : missing_) trials.insert(one.trial);
  if (trials.size() <= kMostAlone) {
    for (const Missing& one : missing_)
      sentences.push_back(fmt::format("trial '{}': {} of {} samples of '{}' are not compared {}", one.trial,
                                      one.missing, one.recorded, one.channel, kWhy));
    return;
  }
  std::vector<Missing> by_channel;  // of all trials
  std::vector<std::size_t> count;
  for (const Missing& one : missing_) {
    auto found = std::find_if(by_channel.begin(), by_channel.end(),
                              [&](const Missing& other) { return other.channel == one.channel; });
    if (found == by_channel.end()) {
      found = by_channel.insert(found, {"", one.channel, 0, 0});
      count.push_back(0);
    }
    found->missing += one.missing;
    found->recorded += one.recorded;
    ++count[static_cast<std::size_t>(found - by_channel.begin())];
  }
  for (std::size_t c = 0; c < by_channel.size(); ++c)
    sentences.push_back(fmt::format("of '{}', {} of {} samples in {} trials are not compared {}",
                                    by_channel[c].channel, by_channel[c].missing, by_channel[c].recorded,
                                    count[c], kWhy));
}

std::vector<std::string> StanceNotes::Sentences() const {
  std::vector<std::string> sentences;
  for (const Said& one : held_) sentences.push_back(Several(one.of) + ": " + one.what);
  AddPoses(sentences);
  for (const Said& one : no_load_) sentences.push_back(Several(one.of) + ": " + one.what);
  AddHeights(sentences);
  AddMissing(sentences);
  return sentences;
}

}  // namespace sinew
