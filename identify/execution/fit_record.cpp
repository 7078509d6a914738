#include "identify/execution/fit_record.h"

#include <utility>

#include "identify/execution/ranks.h"

namespace sinew {

FitRecord::~FitRecord() {
  if (shared.ranks != nullptr) shared.ranks->Attach({});
}

std::optional<FitRecord::Answer> FitRecord::Find(const Digest& question) const {
  const std::lock_guard lock(mutex_);
  const auto found = answers_.find(question.value());
  return found == answers_.end() ? std::nullopt : std::optional(found->second);
}

void FitRecord::Keep(const Digest& question, Answer answer) {
  if (shared.ranks != nullptr && Ranks::InsidePiece()) shared.ranks->Share(question.value(), answer);
  {
    const std::lock_guard lock(mutex_);
    answers_.emplace(question.value(), std::move(answer));
  }
  if (after_keep) after_keep();
}

FitRecord::Answers FitRecord::All() const {
  const std::lock_guard lock(mutex_);
  return answers_;
}

std::size_t FitRecord::size() const {
  const std::lock_guard lock(mutex_);
  return answers_.size();
}

void FitRecord::Restore(Answers answers) {
  const std::lock_guard lock(mutex_);
  answers_ = std::move(answers);
}

void FitRecord::Share(const SharedWork& work) {
  shared = work;
  if (shared.ranks == nullptr) return;
  shared.ranks->Attach([this](const Digest::Value& question, const Answer& answer) {
    const std::lock_guard lock(mutex_);
    answers_.emplace(question, answer);
  });
}

void FitRecord::TellOfArrivals() const {
  if (after_keep) after_keep();
}

}  // namespace sinew
