#include "identify/diagnosis/select/candidate_sets.h"

#include <algorithm>

namespace sinew::diagnosis {

std::vector<int> With(std::vector<int> set, int c) {
  set.insert(std::lower_bound(set.begin(), set.end(), c), c);
  return set;
}

std::vector<int> Without(std::vector<int> set, int c) {
  set.erase(std::remove(set.begin(), set.end(), c), set.end());
  return set;
}

bool Contains(const std::vector<int>& set, int c) {
  return std::binary_search(set.begin(), set.end(), c);
}

bool IsOneLess(const std::vector<int>& smaller, const std::vector<int>& set) {
  return smaller.size() + 1 == set.size() &&
         std::includes(set.begin(), set.end(), smaller.begin(), smaller.end());
}

int MemberBeyond(const std::vector<int>& smaller, const std::vector<int>& set) {
  return *std::mismatch(smaller.begin(), smaller.end(), set.begin()).second;
}

}  // namespace sinew::diagnosis
