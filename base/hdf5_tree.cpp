#include "base/hdf5_tree.h"

#include <utility>

#include "base/text.h"

namespace sinew {

Hdf5Node& Hdf5Node::At(std::string_view path) {
  Hdf5Node* node = this;
  for (const std::string_view part : Split(path, '/')) {
    if (!part.empty()) node = &node->children[std::string(part)];
  }
  return *node;
}

const Hdf5Node* Hdf5Node::Find(std::string_view path) const {
  const Hdf5Node* node = this;
  for (const std::string_view part : Split(path, '/')) {
    if (part.empty()) continue;
    const auto child = node->children.find(std::string(part));
    if (child == node->children.end()) return nullptr;
    node = &child->second;
  }
  return node;
}

void Hdf5Node::SetVector(std::vector<double> values) {
  const std::size_t size = values.size();
  data = Hdf5Array{{size}, std::move(values)};
}

void Hdf5Node::SetScalar(double value) {
  data = Hdf5Array{{}, {value}};
}

void Hdf5Node::SetMatrix(std::size_t rows, std::size_t columns, std::vector<double> values) {
  data = Hdf5Array{{rows, columns}, std::move(values)};
}

double Hdf5Node::Number(const std::string& attribute, double fallback) const {
  const auto found = attributes.find(attribute);
  if (found == attributes.end()) return fallback;
  if (const auto* integer = std::get_if<std::int64_t>(&found->second)) return static_cast<double>(*integer);
  if (const auto* number = std::get_if<double>(&found->second)) return *number;
  return fallback;
}

std::string Hdf5Node::Text(const std::string& attribute, const std::string& fallback) const {
  const auto found = attributes.find(attribute);
  if (found == attributes.end()) return fallback;
  const auto* text = std::get_if<std::string>(&found->second);
  return text != nullptr ? *text : fallback;
}

}  // namespace sinew
