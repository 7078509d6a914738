#include "identify/noise/channel_equations.h"

#include <algorithm>
#include <map>

namespace sinew::noise {
namespace {

constexpr double kRidge = 1e-12;

// The diagonal of a column that is eliminated now. @param whole what it was before other eliminations
void Steady(double whole, double& diagonal) {
  if (whole > 0) {
    diagonal += kRidge * whole;
  } else {
    diagonal = 1;
  }
}

}  // namespace

void JointEquations::SetZero(Eigen::Index joint) {
  lower.setZero(joint + 1, joint + 1);
  diagonal.setZero(joint);
  log_determinant = 0;
}

void JointEquations::operator+=(const JointEquations& other) {
  lower += other.lower;
  diagonal += other.diagonal;
  log_determinant += other.log_determinant;
}

ChannelEquations::ChannelEquations(const std::vector<std::vector<int>>& columns,
                                   const std::vector<int>& joint_place, Eigen::Index joint)
    : joint_(joint) {
  std::map<int, int> count;  // blocks that have a column
  for (const auto& of_block : columns) {
    for (const int column : of_block) ++count[column];
  }
  columns_ = static_cast<int>(count.size());
  const auto place_of = [&](int column) { return joint_place[static_cast<std::size_t>(column)]; };
  const auto belongs_to_block = [&](int column) { return place_of(column) < 0 && count.at(column) == 1; };
  std::map<int, Eigen::Index> border;
  for (const auto& [column, blocks] : count) {
    if (place_of(column) < 0 && blocks > 1) border.emplace(column, channels_own_++);
  }
  for (const auto& [column, blocks] : count) {
    if (place_of(column) < 0) continue;
    border.emplace(column, static_cast<Eigen::Index>(border.size()));
    joint_of_border_.push_back(place_of(column));
  }
  const auto residual = static_cast<Eigen::Index>(border.size());
  border_.resize(residual + 1, residual + 1);
  border_diagonal_.resize(residual);
  for (const auto& of_block : columns) {
    BlockPart part;
    part.own = std::count_if(of_block.begin(), of_block.end(), belongs_to_block);
    Eigen::Index own = 0;
    for (const int column : of_block) {
      if (belongs_to_block(column)) {
        part.place.push_back(own++);
      } else {
        part.place.push_back(part.own + static_cast<Eigen::Index>(part.border.size()));
        part.border.push_back(border.at(column));
      }
    }
    part.place.push_back(static_cast<Eigen::Index>(of_block.size()));
    part.border.push_back(residual);
    blocks_.push_back(std::move(part));
  }
}

bool ChannelEquations::Eliminate(const LaggedProducts& products, const Vector& value, JointEquations& left) {
  left.SetZero(joint_);
  border_.setZero();
  border_diagonal_.setZero();
  const Eigen::Index residual = border_.rows() - 1;
  for (BlockPart& part : blocks_)
    part.matrix.setZero(static_cast<Eigen::Index>(part.place.size()),
                        static_cast<Eigen::Index>(part.place.size()));
  for (std::size_t i = 0; i < products.entries().size(); ++i) {
    const LaggedProducts::Entry& entry = products.entries()[i];
    BlockPart& part = blocks_[entry.block];
    const auto [low, high] = std::minmax(part.place[entry.row], part.place[entry.column]);
    part.matrix(high, low) += value[static_cast<Eigen::Index>(i)];
  }
  for (BlockPart& part : blocks_) {
    for (Eigen::Index c = 0; c < part.own; ++c) Steady(part.matrix(c, c), part.matrix(c, c));
    for (std::size_t c = 0; c + 1 < part.border.size(); ++c) {
      const Eigen::Index at = part.own + static_cast<Eigen::Index>(c);
      border_diagonal_[part.border[c]] += part.matrix(at, at);
    }
    if (!part.elimination.Eliminate(part.matrix, part.own)) return false;
    left.log_determinant += part.elimination.log_determinant();
    for (std::size_t c = 0; c < part.border.size(); ++c) {
      for (std::size_t r = c; r < part.border.size(); ++r) {
        const auto [low, high] = std::minmax(part.border[c], part.border[r]);
        border_(high, low) +=
            part.matrix(part.own + static_cast<Eigen::Index>(r), part.own + static_cast<Eigen::Index>(c));
      }
    }
  }
  for (Eigen::Index c = 0; c < channels_own_; ++c) Steady(border_diagonal_[c], border_(c, c));
  if (!elimination_.Eliminate(border_, channels_own_)) return false;
  left.log_determinant += elimination_.log_determinant();
  const auto place = [&](Eigen::Index border) {
    return border == residual ? joint_ : joint_of_border_[static_cast<std::size_t>(border - channels_own_)];
  };
  for (Eigen::Index c = channels_own_; c <= residual; ++c) {
    if (c < residual) left.diagonal[place(c)] = border_diagonal_[c];
    for (Eigen::Index r = c; r <= residual; ++r) {
      left.lower(std::max(place(c), place(r)), std::min(place(c), place(r))) = border_(r, c);
    }
  }
  return true;
}

void ChannelEquations::CarryBack(const LaggedProducts& products, const Matrix& of_left, Vector& slopes) {
  std::vector<Eigen::Index> place(joint_of_border_);
  place.push_back(joint_);
  const auto rest = static_cast<Eigen::Index>(place.size());
  of_rest_.resize(rest, rest);
  for (Eigen::Index c = 0; c < rest; ++c) {
    for (Eigen::Index r = 0; r < rest; ++r)
      of_rest_(r, c) = of_left(place[static_cast<std::size_t>(r)], place[static_cast<std::size_t>(c)]);
  }
  elimination_.CarryBack(border_, of_rest_, of_border_);
  slopes.resize(static_cast<Eigen::Index>(products.entries().size()));
  std::size_t i = 0;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    BlockPart& part = blocks_[b];
    const auto open = static_cast<Eigen::Index>(part.border.size());
    of_rest_.resize(open, open);
    for (Eigen::Index c = 0; c < open; ++c) {
      for (Eigen::Index r = 0; r < open; ++r)
        of_rest_(r, c) =
            of_border_(part.border[static_cast<std::size_t>(r)], part.border[static_cast<std::size_t>(c)]);
    }
    part.elimination.CarryBack(part.matrix, of_rest_, of_block_);
    // Entries come block by block.
    for (; i < products.entries().size() && products.entries()[i].block == b; ++i) {
      const LaggedProducts::Entry& entry = products.entries()[i];
      const double slope = of_block_(part.place[entry.row], part.place[entry.column]);
      slopes[static_cast<Eigen::Index>(i)] = entry.row == entry.column ? slope : 2 * slope;
    }
  }
}

bool EliminateJoint(JointEquations& equations, Elimination& elimination) {
  for (Eigen::Index c = 0; c < equations.diagonal.size(); ++c)
    Steady(equations.diagonal[c], equations.lower(c, c));
  return elimination.Eliminate(equations.lower, equations.diagonal.size());
}

}  // namespace sinew::noise
