#include "problems/contact/soles/sole_proposal.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "base/text.h"
#include "datasets/stances/stances.h"
#include "models/multibody/osim_reader.h"
#include "problems/contact/settings.h"

namespace sinew {
namespace {

// [N m] A person's free moments are within 10 N m; friction under 5 % of the load makes a twentieth of that.
constexpr double kLargestUnloadedMoment = 2;

constexpr double kThickness = 0.02;  // [m] only the bottom of a box has springs
const std::array<const char*, 3> kPatchNames{"rearfoot", "forefoot", "toes"};

// A record whose plate a foot stands on.
struct Standing {
  const PlateRecord* record = nullptr;
  int foot = -1;  // its first body
};

SolePatch Mirrored(const SolePatch& patch, const MirroredBody& to) {
  SolePatch mirrored = patch;
  mirrored.body = to.body;
  mirrored.forward = to.mirror * patch.forward;
  mirrored.up = to.mirror * patch.up;
  mirrored.middle = -patch.middle;
  return mirrored;
}

SolePatch MeanOf(const SolePatch& a, const SolePatch& b) {
  SolePatch mean = a;
  mean.up = (a.up + b.up).normalized();
  const Vec3 forward = a.forward + b.forward;
  mean.forward = (forward - mean.up.dot(forward) * mean.up).normalized();
  mean.offset = 0.5 * (a.offset + b.offset);
  mean.back = 0.5 * (a.back + b.back);
  mean.front = 0.5 * (a.front + b.front);
  mean.middle = 0.5 * (a.middle + b.middle);
  mean.width = 0.5 * (a.width + b.width);
  return mean;
}

// Every patch on the body of the other side that corresponds to its own.
std::vector<SolePatch> OnOtherSide(const FootEstimate& foot, const std::vector<MirroredBody>& others) {
  std::vector<SolePatch> patches;
  for (const SolePatch& patch : foot.patches) {
    const auto at = std::find(foot.bodies.begin(), foot.bodies.end(), patch.body) - foot.bodies.begin();
    patches.push_back(Mirrored(patch, others[static_cast<std::size_t>(at)]));
  }
  return patches;
}

double Rounded(double value) {
  return std::round(value * 1e4) / 1e4 + 0.0;
}
Vec3 Rounded(const Vec3& v) {
  return {Rounded(v.x()), Rounded(v.y()), Rounded(v.z())};
}

// Body-fixed x-y-z angles of axes.
Vec3 AnglesOf(const SolePatch& patch) {
  Mat3 r;
  r.col(0) = patch.forward;
  r.col(1) = patch.up;
  r.col(2) = patch.side();
  return {std::atan2(-r(1, 2), r(2, 2)), std::asin(std::clamp(r(0, 2), -1.0, 1.0)),
          std::atan2(-r(0, 1), r(0, 0))};
}

class Proposer {
 public:
  Proposer(const Dataset& data, const OsimModel& osim, const MultibodyModel& model, const BodyTree& tree,
           double floor_height)
      : data_(data),
        osim_(osim),
        model_(model),
        tree_(tree),
        markers_(MarkersOfBodies(osim, model, data)),
        points_(PointsOfBodies(osim, model, markers_)) {
    proposal_.floor_height = floor_height;
  }

  Result<SoleProposal> Run() {
    SINEW_ASSIGN(records_, ReadPlateRecords(data_, model_, proposal_.floor_height, proposal_.skipped));
    FindFeet();
    SINEW_TRY(CheckPlates());
    EstimateFeet();
    PairFeet();
    CheckHeldOut();
    AddRegions();
    AddBelt();
    AddStiffness();
    ChooseChannels();
    return std::move(proposal_);
  }

 private:
  [[nodiscard]] const std::string& Name(int body) const {
    return model_.body_names()[static_cast<std::size_t>(body)];
  }

  void Report(const PlateRecord& record, const PlateFoot& found) {
    proposal_.findings.push_back({record.trial, record.plate, found, found.body > 0 ? Name(found.body) : "",
                                  found.other_body > 0 ? Name(found.other_body) : ""});
  }

  void FindFeet() {
    const double weight = model_.total_mass_kg() * osim_.gravity.norm();
    for (const PlateRecord& record : records_) {
      const PlateFoot found = FindFoot(record, tree_, points_, weight, proposal_.floor_height);
      if (found.fault != PlateFault::kNone) {
        Report(record, found);
      } else {
        standing_.push_back({&record, found.body});
      }
    }
    // Stances of one limb may name several of its bodies: most of them decide, of equally many the inner one.
    std::map<int, int> votes;
    for (const Standing& s : standing_) ++votes[s.foot];
    for (Standing& s : standing_) {
      const int own = s.foot;
      for (const auto& [body, count] : votes) {
        if (!tree_.SameLimb(body, own)) continue;
        const int most = votes[s.foot];
        if (count > most || (count == most && tree_.depth(body) < tree_.depth(s.foot))) s.foot = body;
      }
    }
  }

  // A region belongs to one plate, and the forces of a plate to one foot.
  Status CheckPlates() const {
    for (const Standing& a : standing_) {
      for (const Standing& b : standing_) {
        if (a.record->plate != b.record->plate || a.foot == b.foot) continue;
        return Fail(
            "plate '{}' carries '{}' in trial '{}' and '{}' in trial '{}': expected one name per foot and "
            "plate; "
            "import the trials with names of their own (--plates)",
            a.record->plate, Name(a.foot), a.record->trial, Name(b.foot), b.record->trial);
      }
    }
    return {};
  }

  [[nodiscard]] std::vector<const PlateRecord*> Fitted(int foot) const {
    std::vector<const PlateRecord*> records;
    for (const Standing& s : standing_) {
      if (s.foot == foot && s.record->role == Role::kTrain) records.push_back(s.record);
    }
    return records;
  }

  // Takes records out whose centre of pressure or force does not fit the foot. @return whether there were any
  bool DropWrong(int foot, const FootEstimate& estimate, Role role) {
    const auto wrong = [&](const Standing& s) {
      if (s.foot != foot || s.record->role != role) return false;
      PlateFoot found;
      found.body = foot;
      found.fault = CopMovesAcross(*s.record, estimate)
                        ? PlateFault::kCopAcross
                        : ForceDirectionFault(*s.record, ForwardOf(*s.record, estimate));
      if (found.fault == PlateFault::kNone) return false;
      Report(*s.record, found);
      return true;
    };
    const auto end = std::remove_if(standing_.begin(), standing_.end(), wrong);
    const bool any = end != standing_.end();
    standing_.erase(end, standing_.end());
    return any;
  }

  void EstimateFeet() {
    std::set<int> feet;
    for (const Standing& s : standing_) feet.insert(s.foot);
    for (const int foot : feet) {
      for (;;) {
        const auto records = Fitted(foot);
        if (records.empty()) break;
        auto estimate =
            EstimateFoot(records, tree_.Outwards(foot), markers_, points_, proposal_.floor_height);
        if (!estimate) {
          proposal_.skipped.push_back(fmt::format("'{}': {}", Name(foot), estimate.error().message));
          break;
        }
        if (DropWrong(foot, *estimate, Role::kTrain)) continue;
        estimates_.emplace(foot, std::move(*estimate));
        break;
      }
    }
  }

  void PairFeet() {
    const std::map<int, FootEstimate> own = estimates_;
    std::set<int> feet;
    for (const Standing& s : standing_) feet.insert(s.foot);
    std::set<int> done;
    for (const int foot : feet) {
      if (done.count(foot) > 0) continue;
      const auto others = tree_.OtherSide(foot);
      const int other = others ? others->front().body : -1;
      const auto back = other > 0 ? tree_.OtherSide(other) : std::nullopt;
      const auto here = own.find(foot);
      const auto there = own.find(other);
      if (here == own.end() && (there == own.end() || !back)) {
        proposal_.skipped.push_back(
            fmt::format("'{}': no training stance of it, and none of a foot on the other side", Name(foot)));
        continue;
      }
      FootEstimate estimate = here != own.end() ? here->second : there->second;
      SoleSource source = SoleSource::kOwn;
      if (here == own.end()) {
        source = SoleSource::kOther;
        estimate.patches = OnOtherSide(there->second, *back);
        estimate.bodies = tree_.Outwards(foot);
      } else if (there != own.end() && back) {
        const auto mirrored = OnOtherSide(there->second, *back);
        const SolePatch& rear = estimate.patches.front();
        const double angle = std::acos(std::clamp(rear.up.dot(mirrored.front().up), -1.0, 1.0));
        const double height = mirrored.front().up.dot(rear.centre()) - mirrored.front().offset;
        FootEstimate second = there->second;
        if (angle < kFeetDifferAngle && std::abs(height) < kFeetDifferHeight) {
          source = SoleSource::kBoth;
          for (std::size_t p = 0; p < estimate.patches.size(); ++p)
            estimate.patches[p] = MeanOf(estimate.patches[p], mirrored[p]);
          second.patches = OnOtherSide(estimate, *others);
        }
        AddFoot(foot, estimate, source, other, angle, height);
        AddFoot(other, second, source, foot, angle, -height);
        done.insert({foot, other});
        continue;
      }
      AddFoot(foot, estimate, source, other);
      done.insert(foot);
      if (other > 0 && feet.count(other) == 0) {
        FootEstimate mirrored = estimate;
        mirrored.patches = OnOtherSide(estimate, *others);
        mirrored.bodies = tree_.Outwards(other);
        AddFoot(other, mirrored, SoleSource::kNoPlate, foot);
      }
    }
  }

  void AddFoot(int foot, const FootEstimate& estimate, SoleSource source, int other, double angle = 0,
               double height = 0) {
    ProposedFoot proposed;
    for (const int body : tree_.Outwards(foot)) proposed.bodies.push_back(Name(body));
    proposed.source = source;
    if (other > 0) proposed.other = Name(other);
    proposed.differs_angle = angle;
    proposed.differs_height = height;
    proposed.estimate = estimate;
    proposal_.feet.push_back(std::move(proposed));
  }

  void CheckHeldOut() {
    for (const ProposedFoot& foot : proposal_.feet)
      DropWrong(foot.estimate.bodies.front(), foot.estimate, Role::kValidate);
  }

  void AddRegions() {
    for (std::size_t f = 0; f < proposal_.feet.size(); ++f) {
      ProposedFoot& foot = proposal_.feet[f];
      std::set<std::string> plates;
      for (const Standing& s : standing_) {
        if (s.foot == foot.estimate.bodies.front()) plates.insert(s.record->plate);
      }
      if (foot.source == SoleSource::kNoPlate) plates.insert(foot.bodies.front());
      foot.plates.assign(plates.begin(), plates.end());
      for (const std::string& plate : foot.plates) {
        for (std::size_t p = 0; p < foot.estimate.patches.size(); ++p) {
          const SolePatch& patch = foot.estimate.patches[p];
          ProposedRegion region;
          region.name = fmt::format("{}_{}", foot.bodies.front(), kPatchNames[p]);
          if (foot.plates.size() > 1) region.name += "_" + plate;
          region.body = Name(patch.body);
          region.plate = plate;
          region.foot = f;
          region.patch = p;
          region.position = Rounded(patch.centre());
          region.orientation = Rounded(AnglesOf(patch));
          region.size = Rounded(Vec3(patch.front - patch.back, kThickness, patch.width));
          const double spacing = foot.estimate.length / SoleRules::kSpringsAlong;
          region.strips = {static_cast<int>(std::ceil(region.size.x() / spacing)),
                           static_cast<int>(std::ceil(region.size.z() / spacing))};
          proposal_.regions.push_back(std::move(region));
        }
      }
    }
  }

  void AddBelt() {
    std::vector<StandingFoot> feet;
    for (const ProposedFoot& foot : proposal_.feet) {
      for (const PlateRecord* record : Fitted(foot.estimate.bodies.front()))
        feet.push_back({record, &foot.estimate});
    }
    proposal_.belt = FindBeltVelocity(feet, data_, osim_, model_);
    proposal_.belt.x = std::round(proposal_.belt.x * 1e3) / 1e3;
    proposal_.belt.z = std::round(proposal_.belt.z * 1e3) / 1e3;
  }

  void AddStiffness() {
    constexpr double kDepth = 0.01;  // of the length
    for (const ProposedFoot& foot : proposal_.feet) {
      double area = 0;
      for (const SolePatch& patch : foot.estimate.patches) area += (patch.front - patch.back) * patch.width;
      for (const PlateRecord* record : Fitted(foot.estimate.bodies.front())) {
        const double start = record->peak / (area * kDepth * foot.estimate.length);
        proposal_.stiffness_start = std::max(proposal_.stiffness_start, start);
      }
    }
  }

  // Mean free moment while the plate carries 1 to 5 % of its greatest load: no friction turns it then. NaN:
  // not measured.
  static double UnloadedMoment(const Trial& trial, const std::string& plate) {
    constexpr double kLeast = 0.01;
    constexpr double kMost = 0.05;
    const auto force = trial.Find(plate + "_force_y");
    const auto moment = trial.Find(plate + "_moment_y");
    if (!force || !moment || force.grid != moment.grid) return std::numeric_limits<double>::quiet_NaN();
    double peak = 0;
    for (const double f : force.channel->values) {
      if (std::isfinite(f)) peak = std::max(peak, f);
    }
    double sum = 0;
    double count = 0;
    for (std::size_t i = 0; i < force.channel->values.size(); ++i) {
      const double f = force.channel->values[i];
      const double m = moment.channel->values[i];
      if (!(f > kLeast * peak && f < kMost * peak) || !std::isfinite(m)) continue;
      sum += m;
      count += 1;
    }
    return count == 0 ? std::numeric_limits<double>::quiet_NaN() : sum / count;
  }

  // A channel that is fitted must be there on every plate of every trial that takes part.
  void ChooseChannels() {
    std::set<std::string> plates;
    for (const ProposedRegion& region : proposal_.regions) plates.insert(region.plate);
    for (const std::string& channel : kContactChannels) {
      bool everywhere = true;
      for (const auto& [name, trial] : data_.trials) {
        for (const std::string& plate : PlateNames(trial)) {
          if (plates.count(plate) == 0) continue;
          everywhere &= Varies(trial, plate + "_" + channel);
          if (channel != "moment_y" || !everywhere) continue;
          const double offset = UnloadedMoment(trial, plate);
          if (!(std::abs(offset) > kLargestUnloadedMoment)) continue;
          everywhere = false;
          proposal_.skipped.push_back(fmt::format(
              "trial '{}', {}: the free moment is {:.1f} N*m while the plate carries next to nothing: an "
              "offset, so that free moments are not fitted",
              name, plate, offset));
        }
      }
      (everywhere ? proposal_.fit : proposal_.not_fit).push_back(channel);
    }
  }

  static bool Varies(const Trial& trial, const std::string& channel) {
    const auto found = trial.Find(channel);
    if (!found) return false;
    std::optional<double> first;
    for (const double value : found.channel->values) {
      if (!std::isfinite(value)) continue;
      if (!first) first = value;
      if (value != *first) return true;
    }
    return false;
  }

  const Dataset& data_;
  const OsimModel& osim_;
  const MultibodyModel& model_;
  const BodyTree& tree_;
  BodyPoints markers_;
  BodyPoints points_;
  std::vector<PlateRecord> records_;
  std::vector<Standing> standing_;
  std::map<int, FootEstimate> estimates_;  // by their first body
  SoleProposal proposal_;
};

}  // namespace

Result<SoleProposal> ProposeSoles(const Dataset& data, const std::string& model_file, double floor_height) {
  const auto file = data.files.find(model_file);
  if (file == data.files.end())
    return Fail("holds no file '{}': import the .osim that the motion belongs to", model_file);
  SINEW_ASSIGN(const OsimModel osim, ReadOsim(file->second, model_file));
  SINEW_ASSIGN(const MultibodyModel model, MultibodyModel::Build(osim));
  SINEW_ASSIGN(const BodyTree tree, BodyTree::Of(osim, model));
  return Proposer(data, osim, model, tree, floor_height).Run();
}

}  // namespace sinew
