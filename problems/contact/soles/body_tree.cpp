#include "problems/contact/soles/body_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sinew {

Result<BodyTree> BodyTree::Of(const OsimModel& model, const MultibodyModel& multibody) {
  const std::size_t count = multibody.body_names().size();
  BodyTree tree;
  tree.parents_.assign(count, -1);
  tree.masses_.assign(count, 0.0);
  for (const OsimJoint& joint : model.joints) {
    SINEW_ASSIGN(const int parent, multibody.BodyIndex(joint.parent.body));
    SINEW_ASSIGN(const int child, multibody.BodyIndex(joint.child.body));
    tree.parents_[static_cast<std::size_t>(child)] = parent;
  }
  for (const OsimBody& body : model.bodies) {
    SINEW_ASSIGN(const int index, multibody.BodyIndex(body.name));
    tree.masses_[static_cast<std::size_t>(index)] = body.mass_kg;
  }
  // Defaults may be those of a standing trial, which no two legs share.
  std::vector<int> all(count);
  std::iota(all.begin(), all.end(), 0);
  const Vector zeros = Vector::Zero(multibody.default_values().size());
  SINEW_ASSIGN(tree.zero_, multibody.BodyMotionAt(zeros, zeros, all));
  return tree;
}

int BodyTree::depth(int body) const {
  int joints = 0;
  for (int at = body; parent(at) >= 0; at = parent(at)) ++joints;
  return joints;
}

int BodyTree::Root(int body) const {
  while (depth(body) > 1) body = parent(body);
  return body;
}

std::vector<int> BodyTree::Outwards(int body) const {
  std::vector<int> chain{body};
  for (;;) {
    int next = -1;
    for (int child = 0; child < static_cast<int>(parents_.size()); ++child) {
      if (parent(child) != chain.back()) continue;
      if (next < 0 || masses_[static_cast<std::size_t>(child)] > masses_[static_cast<std::size_t>(next)])
        next = child;
    }
    if (next < 0) return chain;
    chain.push_back(next);
  }
}

bool BodyTree::SameLimb(int body, int other) const {
  for (int at = body; at >= 0; at = parent(at)) {
    if (at == other) return true;
  }
  for (int at = other; at >= 0; at = parent(at)) {
    if (at == body) return true;
  }
  return false;
}

std::optional<std::vector<MirroredBody>> BodyTree::OtherSide(int body) const {
  constexpr double kMassDifference = 0.1;       // of the mass
  constexpr double kDistanceDifference = 0.05;  // of the distance from the root
  constexpr double kApart = 0.01;               // [m]
  int root = body;
  while (parent(root) > 0) root = parent(root);
  const auto pose = [this](int of) -> const BodyMotion& { return zero_[static_cast<std::size_t>(of)]; };
  const auto reach = [&](int of) { return (pose(of).position - pose(root).position).norm(); };
  const std::vector<int> chain = Outwards(body);

  int best = -1;
  double least = 1;
  for (int other = 1; other < static_cast<int>(parents_.size()); ++other) {
    if (SameLimb(body, other) || depth(other) != depth(body)) continue;
    if (Outwards(other).size() != chain.size()) continue;
    if ((pose(other).position - pose(body).position).norm() < kApart) continue;
    const double mass = masses_[static_cast<std::size_t>(body)];
    const double by_mass =
        std::abs(masses_[static_cast<std::size_t>(other)] - mass) / std::max(mass, 1e-9) / kMassDifference;
    const double by_reach =
        std::abs(reach(other) - reach(body)) / std::max(reach(body), 1e-9) / kDistanceDifference;
    const double difference = std::max(by_mass, by_reach);
    if (difference < least) best = other, least = difference;
  }
  if (best < 0) return std::nullopt;

  // Across the plane between the two: an axis of the root where that is nearly one.
  constexpr double kNearly = 0.98;
  Vec3 across = (pose(best).position - pose(body).position).normalized();
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 of_root = pose(root).rotation.col(axis);
    if (std::abs(of_root.dot(across)) > kNearly) across = of_root;
  }
  const Mat3 reflection = Mat3::Identity() - 2 * across * across.transpose();
  const std::vector<int> others = Outwards(best);
  std::vector<MirroredBody> mirrored;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    mirrored.push_back(
        {others[i], pose(others[i]).rotation.transpose() * reflection * pose(chain[i]).rotation});
  }
  return mirrored;
}

}  // namespace sinew
