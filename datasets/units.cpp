#include "datasets/units.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <vector>

#include "base/constants.h"
#include "base/text.h"

namespace sinew {
namespace {

constexpr double kRadPerDeg = kPi / 180;
constexpr const char* kCelsius = "degC";  // no unit of products: its zero is not that of kelvin
constexpr double kCelsiusZero = 273.15;   // [K]

// The symbols that SI units are written with, in the order in which a product names them.
enum Symbol { kKg, kN, kJ, kW, kPa, kV, kA, kOhm, kH, kF, kM, kS, kRad, kHz, kK, kSymbolCount };
constexpr std::array<std::string_view, kSymbolCount> kSymbolNames = {
    "kg", "N", "J", "W", "Pa", "V", "A", "ohm", "H", "F", "m", "s", "rad", "Hz", "K"};

struct Atom {
  std::string_view name;
  double factor = 1;
  Symbol first = kSymbolCount;
  int first_power = 0;
  Symbol second = kSymbolCount;
  int second_power = 0;
};

constexpr Atom kAtoms[] = {
    {"1"},
    {"%", 0.01},
    {"m", 1, kM, 1},
    {"km", 1e3, kM, 1},
    {"cm", 1e-2, kM, 1},
    {"mm", 1e-3, kM, 1},
    {"um", 1e-6, kM, 1},
    {"s", 1, kS, 1},
    {"ms", 1e-3, kS, 1},
    {"us", 1e-6, kS, 1},
    {"min", 60, kS, 1},
    {"h", 3600, kS, 1},
    {"rad", 1, kRad, 1},
    {"mrad", 1e-3, kRad, 1},
    {"deg", kRadPerDeg, kRad, 1},
    {"rev", 2 * kPi, kRad, 1},
    {"rpm", 2 * kPi / 60, kRad, 1, kS, -1},
    {"Hz", 1, kHz, 1},
    {"kHz", 1e3, kHz, 1},
    {"K", 1, kK, 1},
    {"kg", 1, kKg, 1},
    {"N", 1, kN, 1},
    {"mN", 1e-3, kN, 1},
    {"kN", 1e3, kN, 1},
    {"Nm", 1, kN, 1, kM, 1},
    {"Ncm", 1e-2, kN, 1, kM, 1},
    {"Nmm", 1e-3, kN, 1, kM, 1},
    {"mNm", 1e-3, kN, 1, kM, 1},
    {"kNm", 1e3, kN, 1, kM, 1},
    {"J", 1, kJ, 1},
    {"W", 1, kW, 1},
    {"kW", 1e3, kW, 1},
    {"Pa", 1, kPa, 1},
    {"kPa", 1e3, kPa, 1},
    {"MPa", 1e6, kPa, 1},
    {"V", 1, kV, 1},
    {"mV", 1e-3, kV, 1},
    {"uV", 1e-6, kV, 1},
    {"A", 1, kA, 1},
    {"mA", 1e-3, kA, 1},
    {"ohm", 1, kOhm, 1},
    {"H", 1, kH, 1},
    {"mH", 1e-3, kH, 1},
    {"F", 1, kF, 1},
    {"uF", 1e-6, kF, 1},
};

struct Dimension {
  double factor = 1;
  std::array<int, kSymbolCount> powers{};
};

// Letters outside ASCII that people write in units, as this parser reads them.
std::string Ascii(std::string_view unit) {
  static constexpr std::pair<std::string_view, std::string_view> kSpellings[] = {
      {"\xC2\xB5", "u"},     {"\xCE\xBC", "u"}, {"\xC2\xB0", "deg"}, {"\xC2\xB7", "*"},
      {"\xE2\x8B\x85", "*"}, {"\xC2\xB2", "2"}, {"\xC2\xB3", "3"},   {"\xCE\xA9", "ohm"}};
  std::string ascii(unit);
  for (const auto& [written, plain] : kSpellings) {
    for (auto at = ascii.find(written); at != std::string::npos; at = ascii.find(written)) {
      ascii.replace(at, written.size(), plain);
    }
  }
  return ascii;
}

// Recursive descent over: product = factor {("*" | "." | "/" | blanks) factor};
// factor = (name | "(" product ")") [["^"] integer].
class UnitParser {
 public:
  explicit UnitParser(std::string_view text) : rest_(text) {}

  std::optional<Dimension> ParseAll() {
    auto dimension = Product(0);
    if (!rest_.empty()) return std::nullopt;
    return dimension;
  }

 private:
  static constexpr int kDeepest = 8;
  static constexpr int kLargestPower = 9;  // one digit: what Format writes can be read again

  static bool HasSmallPowers(const Dimension& dimension) {
    return std::all_of(dimension.powers.begin(), dimension.powers.end(),
                       [](int power) { return std::abs(power) <= kLargestPower; });
  }

  void SkipBlanks() {
    while (!rest_.empty() && (rest_.front() == ' ' || rest_.front() == '\t')) rest_.remove_prefix(1);
  }

  std::optional<Dimension> Product(int depth) {
    Dimension product;
    int sign = 1;
    while (true) {
      SkipBlanks();
      const auto factor = Factor(depth);
      if (!factor) return std::nullopt;
      product.factor *= sign > 0 ? factor->factor : 1 / factor->factor;
      for (int i = 0; i < kSymbolCount; ++i) product.powers[i] += sign * factor->powers[i];
      if (!HasSmallPowers(product)) return std::nullopt;

      const bool blank = !rest_.empty() && (rest_.front() == ' ' || rest_.front() == '\t');
      SkipBlanks();
      if (rest_.empty() || rest_.front() == ')') return product;
      sign = rest_.front() == '/' ? -1 : 1;
      if (rest_.front() == '*' || rest_.front() == '.' || rest_.front() == '/') {
        rest_.remove_prefix(1);
      } else if (!blank) {
        return std::nullopt;
      }
    }
  }

  std::optional<Dimension> Factor(int depth) {
    auto base = !rest_.empty() && rest_.front() == '(' ? Parenthesis(depth) : Name();
    if (!base) return std::nullopt;
    const auto power = Power();
    if (!power) return std::nullopt;
    base->factor = std::pow(base->factor, *power);
    for (int& symbol_power : base->powers) symbol_power *= *power;
    if (!HasSmallPowers(*base)) return std::nullopt;
    return base;
  }

  std::optional<Dimension> Parenthesis(int depth) {
    if (depth >= kDeepest) return std::nullopt;
    rest_.remove_prefix(1);
    auto inside = Product(depth + 1);
    if (!inside || rest_.empty()) return std::nullopt;
    rest_.remove_prefix(1);
    return inside;
  }

  std::optional<Dimension> Name() {
    std::size_t length = 0;
    while (length < rest_.size() && std::isalpha(static_cast<unsigned char>(rest_[length]))) ++length;
    if (length == 0 && !rest_.empty() && (rest_.front() == '1' || rest_.front() == '%')) length = 1;
    const std::string_view name = rest_.substr(0, length);
    rest_.remove_prefix(length);
    for (const Atom& atom : kAtoms) {
      if (atom.name != name) continue;
      Dimension dimension{atom.factor, {}};
      if (atom.first != kSymbolCount) dimension.powers[atom.first] = atom.first_power;
      if (atom.second != kSymbolCount) dimension.powers[atom.second] = atom.second_power;
      return dimension;
    }
    return std::nullopt;
  }

  // The integer after a name; 1 if there is none, nothing if it is malformed.
  std::optional<int> Power() {
    const bool caret = !rest_.empty() && rest_.front() == '^';
    if (caret) rest_.remove_prefix(1);
    const bool minus = !rest_.empty() && rest_.front() == '-';
    if (minus) rest_.remove_prefix(1);
    if (rest_.empty() || !std::isdigit(static_cast<unsigned char>(rest_.front()))) {
      return caret || minus ? std::nullopt : std::optional<int>(1);
    }
    const int power = rest_.front() - '0';
    rest_.remove_prefix(1);
    if (!rest_.empty() && std::isdigit(static_cast<unsigned char>(rest_.front()))) return std::nullopt;
    return minus ? -power : power;
  }

  std::string_view rest_;
};

std::string Format(const Dimension& dimension) {
  std::vector<std::string> above;
  std::vector<std::string> below;
  for (int i = 0; i < kSymbolCount; ++i) {
    const int power = dimension.powers[i];
    if (power == 0) continue;
    std::string symbol(kSymbolNames[i]);
    if (std::abs(power) > 1) symbol += std::to_string(std::abs(power));
    (power > 0 ? above : below).push_back(symbol);
  }
  std::string text = above.empty() ? "1" : Join(above, "*");
  if (below.size() == 1) text += "/" + below.front();
  if (below.size() > 1) text += "/(" + Join(below, "*") + ")";
  return text;
}

}  // namespace

Result<UnitConversion> ToSi(std::string_view unit) {
  constexpr std::size_t kLongest = 64;
  const std::string_view trimmed = Trim(unit);
  if (trimmed.empty()) return Fail("the unit is empty; write 1 for a number without unit");
  const std::string ascii = Ascii(trimmed.substr(0, kLongest + 1));
  if (ascii == kCelsius) return UnitConversion{"K", 1, kCelsiusZero};
  const auto dimension = trimmed.size() <= kLongest ? UnitParser(ascii).ParseAll() : std::nullopt;
  if (!dimension || !std::isfinite(dimension->factor) || dimension->factor == 0) {
    std::vector<std::string> known;
    for (const Atom& atom : kAtoms) known.emplace_back(atom.name);
    known.emplace_back(kCelsius);
    const auto closest = ClosestName(ascii, known);
    const std::string lead = closest ? "; did you mean '" + *closest + "'? Known are" : "; known are";
    return Fail("unknown unit '{}'{} {} and their products and quotients with powers up to 9 (N*m, m/s2)",
                trimmed.substr(0, kLongest), lead, Join(known, ", "));
  }
  return UnitConversion{Format(*dimension), dimension->factor, 0};
}

}  // namespace sinew
