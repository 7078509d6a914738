// Reading settings from YAML strictly: every unknown key, wrong type and missing value is one error with its
// line.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/error.h"

namespace YAML {  // NOLINT(readability-identifier-naming): yaml-cpp's
class Node;
}

namespace sinew {

/// One value of a YAML document: a map, a list, or a scalar.
class YamlReader {
 public:
  /// @param file name for messages. An empty document is an empty map.
  static Result<YamlReader> Parse(const std::string& text, const std::string& file);

  [[nodiscard]] bool is_map() const;
  [[nodiscard]] bool Has(const std::string& key) const;
  /// @pre is_map(), else an error.
  [[nodiscard]] Result<YamlReader> At(const std::string& key) const;
  /// Errors: not a map; a key that is not among the known ones (with a suggestion).
  [[nodiscard]] Status OnlyKeys(const std::vector<std::string>& known) const;
  /// Keys of a map in their order; error if it is none.
  [[nodiscard]] Result<std::vector<std::string>> Keys() const;
  /// Elements of a list; error if it is none.
  [[nodiscard]] Result<std::vector<YamlReader>> Items() const;

  [[nodiscard]] Result<double> Number() const;  ///< finite
  [[nodiscard]] Result<long> Integer() const;
  [[nodiscard]] Result<std::string> Text() const;
  /// A list of so many finite numbers; any number of them if count is 0.
  [[nodiscard]] Result<std::vector<double>> Numbers(std::size_t count) const;
  [[nodiscard]] Result<std::vector<std::string>> Texts() const;

  // The value at a key, or the fallback if the key is absent.
  [[nodiscard]] Result<double> NumberOr(const std::string& key, double fallback) const;
  /// Errors: also a value out of its range.
  [[nodiscard]] Result<double> NumberOr(const std::string& key, double fallback, double lower,
                                        double upper) const;
  [[nodiscard]] Result<std::string> TextOr(const std::string& key, const std::string& fallback) const;

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] long line() const { return line_; }

 private:
  YamlReader(std::shared_ptr<const YAML::Node> node, std::string file, std::string path, long line);
  [[nodiscard]] tl::unexpected<Error> Expected(const std::string& what) const;

  struct Index;
  /// The value at a key; nullptr if there is none. @pre is_map()
  [[nodiscard]] const YAML::Node* Find(const std::string& key) const;

  std::shared_ptr<const YAML::Node> node_;
  mutable std::shared_ptr<const Index> index_;  // of the keys; made when the first of them is asked for
  std::string file_;
  std::string path_;  // "contact.regions[0].mesh"
  long line_ = 1;
};

}  // namespace sinew
