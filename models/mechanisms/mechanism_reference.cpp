#include "models/mechanisms/mechanism_reference.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "base/assert.h"
#include "base/read_file.h"
#include "base/text.h"
#include "models/mechanisms/converged_curves.h"
#include "models/mechanisms/elliptic.h"

namespace sinew {
namespace {

constexpr double kGravity = 9.81;
constexpr int kSamples = 201;

std::vector<double> Evenly(double duration) {
  std::vector<double> times;
  for (int i = 0; i < kSamples; ++i) times.push_back(duration * i / (kSamples - 1));
  return times;
}

struct Point {
  double x = 0, y = 0;
};

// theta from hanging down, let go at 90 degrees: sin(theta / 2) = k cd(t sqrt(g / l)), k = sin(45 degrees).
Point PendulumAt(double time) {
  constexpr double kParameter = 0.5;
  const JacobiElliptic f = JacobiEllipticAt(time * std::sqrt(kGravity), kParameter);
  const double sine = std::sqrt(kParameter) * f.cn / f.dn;  // of half the angle
  const double cosine = std::sqrt(1 - sine * sine);
  return {-2 * sine * cosine, 2 * sine * sine - 1};
}

// All standing links turn by theta from upright: I theta'' = G sin(theta), theta' = 1 at 0. With chi, half
// the angle from below: chi' = a sqrt(1 - m sin^2 chi), so chi = am(a t - K).
Point WindowsAt(double time, double windows) {
  const double inertia = (windows + 1) / 3 + windows;
  const double torque = kGravity * ((windows + 1) / 2 + windows);
  const double rate = std::sqrt(0.25 + torque / inertia);
  const double parameter = torque / inertia / (rate * rate);
  const JacobiElliptic f = JacobiEllipticAt(rate * time - CompleteElliptic(parameter), parameter);
  return {-2 * f.sn * f.cn, 2 * f.sn * f.sn - 1};
}

template <class At>
std::vector<ReferenceCurve> Planar(double duration, const At& at) {
  std::vector<ReferenceCurve> curves(2);
  for (const double time : Evenly(duration)) {
    const Point p = at(time);
    for (ReferenceCurve& curve : curves) curve.time.push_back(time);
    curves[0].values.push_back(p.x);
    curves[1].values.push_back(p.y);
  }
  return curves;
}

MechanismReference Converged(const ConvergedCurves& converged) {
  MechanismReference reference{converged.source, converged.certain_to, {}};
  const std::size_t samples = converged.values.size() / converged.coordinates;
  for (std::size_t j = 0; j < converged.coordinates; ++j) {
    ReferenceCurve curve;
    for (std::size_t i = 0; i < samples; ++i) {
      curve.time.push_back(converged.duration * static_cast<double>(i) / static_cast<double>(samples - 1));
      curve.values.push_back(converged.values[i * converged.coordinates + j]);
    }
    reference.curves.push_back(std::move(curve));
  }
  return reference;
}

Result<ReferenceCurve> ReadCurve(const std::string& file) {
  SINEW_ASSIGN(const std::string text, ReadFile(file));
  std::istringstream stream(text);
  ReferenceCurve curve;
  std::string line;
  for (long number = 1; std::getline(stream, line); ++number) {
    if (Trim(line).empty()) continue;
    const auto cells = Split(line, ',');
    const auto time = ParseNumber(Trim(cells.front()));
    if (number == 1 && !time) continue;  // the header
    const auto value = cells.size() == 2 ? ParseNumber(Trim(cells.back())) : std::nullopt;
    if (!time || !value || !std::isfinite(*time) || !std::isfinite(*value))
      return FailAt(file, number, "expected 'time,value', two numbers");
    if (!curve.time.empty() && *time <= curve.time.back())
      return FailAt(file, number, "time does not increase");
    curve.time.push_back(*time);
    curve.values.push_back(*value);
  }
  if (curve.time.empty()) return Fail("{}: no samples", file);
  return curve;
}

}  // namespace

MechanismReference BuiltInReference(const Mechanism& mechanism, int windows) {
  if (mechanism.name == "A01")
    return {"exact (Jacobi's elliptic functions)", 1e-13, Planar(mechanism.duration, PendulumAt)};
  if (mechanism.name == "A02") {
    return {"exact (Jacobi's elliptic functions), for windows that stay parallelograms", 1e-12,
            Planar(mechanism.duration, [=](double time) { return WindowsAt(time, windows); })};
  }
  if (mechanism.name == "A03-IVP") {
    // Mazzia & Magherini, Test Set for Initial Value Problem Solvers, release 2.4 (2008), II-11.
    MechanismReference reference{"IVP test set, at 0.03 s", 1e-12, {}};
    for (const double angle :
         {15.81077119629904, -15.75637105984298, 0.04082224013073101, -0.5347301163226948, 0.5244099658805304,
          0.5347301163226948, 1.048080741042263})
      reference.curves.push_back({{mechanism.duration}, {angle}});
    return reference;
  }
  const ConvergedCurves* converged = FindConvergedCurves(mechanism.name);
  SINEW_ASSERT(converged != nullptr, "every mechanism has a reference");
  return Converged(*converged);
}

Result<MechanismReference> ReadReference(const Mechanism& mechanism, const std::string& folder) {
  std::error_code error;
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    files.push_back(entry.path().filename().string());
  if (error) return Fail("{}: cannot be read as a folder of references", folder);
  MechanismReference reference{folder, 0, {}};
  for (const std::string& coordinate : mechanism.coordinates) {
    const std::string begin = mechanism.name + "_";
    const std::string end = "reference_" + coordinate + ".csv";
    std::vector<std::string> found;
    for (const std::string& file : files) {
      const bool fits = file.size() >= begin.size() + end.size() && file.rfind(begin, 0) == 0 &&
                        file.compare(file.size() - end.size(), end.size(), end) == 0;
      if (fits) found.push_back(file);
    }
    if (found.size() != 1) {
      return Fail("{}: {} file {}..{}, expected one", folder, found.empty() ? "no" : "more than one", begin,
                  end);
    }
    SINEW_ASSIGN(ReferenceCurve curve, ReadCurve((std::filesystem::path(folder) / found.front()).string()));
    reference.curves.push_back(std::move(curve));
  }
  return reference;
}

std::vector<double> TimesOf(const MechanismReference& reference) {
  std::vector<double> times;
  for (const ReferenceCurve& curve : reference.curves) {
    for (const double time : curve.time) times.push_back(std::max(0.0, time));
  }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

}  // namespace sinew
