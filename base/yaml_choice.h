// A YAML scalar with one of several allowed words.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/text.h"
#include "base/yaml_reader.h"

namespace sinew {

/// @param choices word and meaning, the default first; not empty. Errors: another word, with a suggestion.
template <class E>
Result<E> ReadChoice(const YamlReader& yaml, const std::string& key,
                     const std::vector<std::pair<std::string, E>>& choices) {
  SINEW_ASSIGN(const std::string word, yaml.TextOr(key, choices.front().first));
  std::vector<std::string> names;
  for (const auto& [name, value] : choices) {
    if (name == word) return value;
    names.push_back(name);
  }
  SINEW_ASSIGN(const YamlReader at, yaml.At(key));
  return FailAt(yaml.file(), at.line(), "{}: '{}'{}", key, word, Suggestion(word, names));
}

}  // namespace sinew
