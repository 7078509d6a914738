#include "identify/text/shapes.h"

#include "base/numbers.h"

namespace sinew::text {

std::string ShapeText(const Shape& shape) {
  if (shape.kind == ShapeKind::kNone) return {};
  if (!shape.simple()) return "no simple shape";
  switch (shape.kind) {
    case ShapeKind::kNone:
      return {};
    case ShapeKind::kLinear:
      return "a straight line";
    case ShapeKind::kQuadraticOdd:
      return "odd, quadratic";
    case ShapeKind::kCubic:
      return "odd, cubic";
    case ShapeKind::kQuadraticEven:
      return "even, quadratic";
    case ShapeKind::kStep:
      return "odd, with a step at zero";
    case ShapeKind::kSaturating:
      return "odd, saturating";
    case ShapeKind::kPeak:
      return "odd, largest near zero";
    case ShapeKind::kPeriodic:
      return "periodic, about every " + Readable(shape.period, 2);
  }
  return {};
}

std::string LawText(const Shape& shape, const std::string& signal) {
  const bool velocity = signal == "velocity" || signal == "speed";
  const bool position = signal == "position";
  const bool time = signal == "time";
  const bool command = signal == "command";
  switch (shape.kind) {
    case ShapeKind::kLinear:
      return velocity ? "viscous friction" : position ? "a spring" : time ? "a drift" : "a gain";
    case ShapeKind::kStep:
      return velocity ? "Coulomb friction" : "";
    case ShapeKind::kQuadraticOdd:
      return velocity ? "quadratic drag" : command ? "gain compression" : "";
    case ShapeKind::kCubic:
      return position ? "a hardening spring" : velocity ? "cubic drag" : "";
    case ShapeKind::kPeriodic:
      return position ? "cogging or ripple" : time ? "a periodic disturbance" : "";
    case ShapeKind::kSaturating:
      return command ? "saturation" : velocity ? "Coulomb friction, smoothed" : "";
    case ShapeKind::kPeak:
      return velocity ? "Stribeck friction" : "";
    case ShapeKind::kNone:
    case ShapeKind::kQuadraticEven:
      return {};
  }
  return {};
}

std::string ShapeText(const UnknownFinding& unknown) {
  switch (unknown.kind) {
    case UnknownKind::kDrift:
      return unknown.curve.back() > unknown.curve.front() ? "grows within a trial" : "shrinks within a trial";
    case UnknownKind::kPeriodic:
      return Readable(unknown.frequency) + " Hz";
    case UnknownKind::kCurve:
      return ShapeText(unknown.shape);
  }
  return {};
}

std::string LawText(const UnknownFinding& unknown) {
  return unknown.kind == UnknownKind::kCurve ? LawText(unknown.shape, unknown.signal) : "";
}

}  // namespace sinew::text
