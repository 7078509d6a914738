#include "base/yaml_limits.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <vector>

namespace sinew {
namespace {

constexpr std::size_t kNode = 16;  // what a node counts besides its characters

// The deepest possible nesting of flow and block collections, without parsing.
bool NestsTooDeep(const std::string& text) {
  std::size_t depth = 0;
  std::size_t dashes = 0;
  for (const char c : text) {
    if (c == '[' || c == '{') ++depth;
    if ((c == ']' || c == '}') && depth > 0) --depth;
    if (c == '\n') dashes = 0;
    if (c == '-' || c == '?') ++dashes;
    if (depth > kDeepestYaml || dashes > 10 * kDeepestYaml) return true;
  }
  return false;
}

std::size_t Sum(std::size_t a, std::size_t b) {
  return std::min(a + b, kMostYaml + 1);  // both are at most that
}

// The size of a document with its aliases written out: all characters of scalars, and kNode for each node.
class Counter : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& /*mark*/) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& /*mark*/, YAML::anchor_t anchor) override { Leaf(anchor, 0); }
  void OnAlias(const YAML::Mark& /*mark*/, YAML::anchor_t anchor) override {
    const auto known = sizes_.find(anchor);
    if (known == sizes_.end()) {
      contains_itself_ = true;
    } else {
      Add(known->second);
    }
  }
  void OnScalar(const YAML::Mark& /*mark*/, const std::string& /*tag*/, YAML::anchor_t anchor,
                const std::string& value) override {
    Leaf(anchor, value.size());
  }
  void OnSequenceStart(const YAML::Mark& /*mark*/, const std::string& /*tag*/, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value /*style*/) override {
    open_.push_back({anchor, kNode});
  }
  void OnSequenceEnd() override { Close(); }
  void OnMapStart(const YAML::Mark& /*mark*/, const std::string& /*tag*/, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value /*style*/) override {
    open_.push_back({anchor, kNode});
  }
  void OnMapEnd() override { Close(); }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool contains_itself() const { return contains_itself_; }

 private:
  struct Open {
    YAML::anchor_t anchor = 0;
    std::size_t size = 0;
  };

  void Leaf(YAML::anchor_t anchor, std::size_t characters) {
    const std::size_t size = std::min(kNode + characters, kMostYaml + 1);
    if (anchor != 0) sizes_[anchor] = size;
    Add(size);
  }
  void Close() {
    const Open closed = open_.back();
    open_.pop_back();
    if (closed.anchor != 0) sizes_[closed.anchor] = closed.size;
    Add(closed.size);
  }
  void Add(std::size_t size) {
    std::size_t& sum = open_.empty() ? size_ : open_.back().size;
    sum = Sum(sum, size);
  }

  std::size_t size_ = 0;
  bool contains_itself_ = false;
  std::vector<Open> open_;
  std::map<YAML::anchor_t, std::size_t> sizes_;
};

}  // namespace

Status CheckYamlLimits(const std::string& text, const std::string& file) {
  if (text.size() > kMostYaml)
    return Fail("{}: has {} bytes, expected at most {}", file, text.size(), kMostYaml);
  if (NestsTooDeep(text)) return FailAt(file, 1, "nests deeper than {} levels", kDeepestYaml);
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  Counter counter;
  parser.HandleNextDocument(counter);
  if (counter.contains_itself()) return FailAt(file, 1, "an alias stands within what it stands for");
  if (counter.size() > kMostYaml)
    return FailAt(file, 1, "its aliases stand for more than {} characters", kMostYaml);
  return {};
}

}  // namespace sinew
