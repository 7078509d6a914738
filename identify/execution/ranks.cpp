#include "identify/execution/ranks.h"

#include <chrono>

namespace sinew {
namespace {

using Clock = std::chrono::steady_clock;

// How often the thread that receives looks for messages: often while there is traffic, else seldom, so that
// it takes no processor time from the work.
constexpr std::chrono::microseconds kBusyInterval{100};
constexpr std::chrono::microseconds kIdleInterval{1000};
constexpr std::chrono::milliseconds kBusyFor{20};
constexpr std::chrono::milliseconds kLookAtInterrupt{50};
// MPI counts bytes with an int. A piece with a longer answer is done by every rank.
constexpr std::size_t kLongest = std::size_t{1} << 30;

thread_local bool inside_piece = false;

bool IsForAll(Message::Kind kind) {
  return kind == Message::Kind::kAnswer || kind == Message::Kind::kPiece;
}

}  // namespace

bool Ranks::InsidePiece() {
  return inside_piece;
}
Ranks::Piece::Piece() : before_(std::exchange(inside_piece, true)) {}
Ranks::Piece::~Piece() {
  inside_piece = before_;
}

Ranks::Ranks(const MakeTransport& make, const std::atomic<bool>* interrupt, std::function<void()> at_end)
    : interrupt_(interrupt), at_end_(std::move(at_end)) {
  thread_ = std::thread([this, make] { Communicate(make); });
  std::unique_lock lock(mutex_);
  arrived_.wait(lock, [&] { return ready_; });
}

Ranks::~Ranks() {
  {
    const std::lock_guard lock(mutex_);
    if (rank_ == 0) {
      ending_ = true;
      for (int other = 1; other < size_; ++other) outgoing_.emplace_back(other, ToBytes({}));
    }
  }
  to_be_sent_.notify_one();
  thread_.join();
}

void Ranks::Communicate(const MakeTransport& make) {
  std::unique_ptr<Transport> transport = make();
  std::unique_lock lock(mutex_);
  rank_ = transport->rank();
  size_ = transport->size();
  size_on_this_machine_ = transport->size_on_this_machine();
  ready_ = true;
  arrived_.notify_all();
  auto busy_until = Clock::now() + kBusyFor;
  for (;;) {
    bool active = !outgoing_.empty();
    while (!outgoing_.empty()) {
      auto [to, bytes] = std::move(outgoing_.front());
      outgoing_.pop_front();
      lock.unlock();
      transport->Send(to, std::move(bytes));
      lock.lock();
    }
    lock.unlock();
    while (auto arrival = transport->Receive()) {
      active = true;
      Handle(std::move(*arrival), *transport);
    }
    const bool all_sent = transport->AllSent();
    lock.lock();
    // Another rank has nothing left to send once its last message (kBye) is here.
    const bool all_received = rank_ != 0 || said_bye_ == size_ - 1;
    if (ending_ && outgoing_.empty() && all_sent && all_received) break;
    const auto now = Clock::now();
    if (active || !all_sent) busy_until = now + kBusyFor;
    to_be_sent_.wait_for(lock, now < busy_until ? kBusyInterval : kIdleInterval,
                         [&] { return !outgoing_.empty(); });
  }
  lock.unlock();
  transport.reset();
  if (rank_ != 0 && at_end_) at_end_();
}

void Ranks::PassOn(const Transport::Arrival& arrival) {
  const std::lock_guard lock(mutex_);
  PostToOthers(arrival.bytes, arrival.from);
}

void Ranks::Handle(Transport::Arrival arrival, Transport& transport) {
  std::optional<Message> parsed = FromBytes(arrival.bytes);
  if (!parsed) return;
  Message& message = *parsed;
  if (rank_ == 0 && IsForAll(message.kind)) PassOn(arrival);
  std::unique_lock lock(mutex_);
  switch (message.kind) {
    case Message::Kind::kDraw: {
      const std::size_t piece = DrawFrom(LoopOf(message.about, message.index));
      lock.unlock();
      transport.Send(arrival.from, ToBytes({Message::Kind::kDrawn, message.about, piece, {}}));
      return;
    }
    case Message::Kind::kDrawn:
      loops_[message.about].drawn.push_back(message.index);
      break;
    case Message::Kind::kAnswer:
      if (keep_) {
        keep_(message.about, message.answer);
      } else {
        waiting_answers_.emplace_back(message.about, std::move(message.answer));
      }
      break;
    case Message::Kind::kPiece: {
      Loop& loop = loops_[message.about];
      ++loop.done;
      loop.arrived.emplace_back(message.index, std::move(message.answer));
      break;
    }
    case Message::Kind::kTask:
    case Message::Kind::kReady:
      received_.push_back({arrival.from, std::move(message)});
      break;
    case Message::Kind::kEnd:
      ending_ = true;
      outgoing_.emplace_back(0, ToBytes({Message::Kind::kBye, {}, 0, {}}));
      break;
    case Message::Kind::kBye:
      ++said_bye_;
      break;
  }
  arrived_.notify_all();
}

void Ranks::Attach(Keep keep) {
  const std::lock_guard lock(mutex_);
  keep_ = std::move(keep);
  for (; keep_ && !waiting_answers_.empty(); waiting_answers_.pop_front())
    keep_(waiting_answers_.front().first, waiting_answers_.front().second);
}

void Ranks::Post(int to, std::string bytes) {
  outgoing_.emplace_back(to, std::move(bytes));
  to_be_sent_.notify_one();
}

void Ranks::PostToOthers(const std::string& bytes, int except) {
  if (rank_ != 0) return Post(0, bytes);
  for (int other = 1; other < size_; ++other) {
    if (other != except) Post(other, bytes);
  }
}

void Ranks::Share(const Digest::Value& question, const Answer& answer) {
  const std::string bytes = ToBytes({Message::Kind::kAnswer, question, 0, answer});
  if (bytes.size() > kLongest) return;
  const std::lock_guard lock(mutex_);
  PostToOthers(bytes, rank_);
}

Digest::Value Ranks::Begin(const Digest& question, std::size_t count) {
  const std::lock_guard lock(mutex_);
  Digest name = question;
  return name.Add(loops_begun_++).Add(static_cast<std::uint64_t>(count)).value();
}

Ranks::Loop& Ranks::LoopOf(const Digest::Value& name, std::size_t count) {
  Loop& loop = loops_[name];
  loop.count = count;
  return loop;
}

std::size_t Ranks::DrawFrom(Loop& loop) const {
  return loop.next < loop.count ? loop.next++ : loop.count;
}

std::optional<std::size_t> Ranks::Draw(const Digest::Value& loop, std::size_t count) {
  std::unique_lock lock(mutex_);
  Loop& wanted = LoopOf(loop, count);
  std::size_t piece = count;
  if (rank_ == 0) {
    piece = DrawFrom(wanted);
  } else {
    Post(0, ToBytes({Message::Kind::kDraw, loop, count, {}}));
    arrived_.wait(lock, [&] { return !wanted.drawn.empty(); });
    piece = wanted.drawn.front();
    wanted.drawn.pop_front();
  }
  return piece < count ? std::optional(piece) : std::nullopt;
}

void Ranks::Finish(const Digest::Value& loop, std::size_t count, std::size_t piece, Answer answer) {
  Message message{Message::Kind::kPiece, loop, piece, std::move(answer)};
  std::string bytes = ToBytes(message);
  if (bytes.size() > kLongest) {
    message.answer = {};
    bytes = ToBytes(message);
  }
  const std::lock_guard lock(mutex_);
  ++LoopOf(loop, count).done;
  PostToOthers(bytes, rank_);
  arrived_.notify_all();
}

std::vector<std::pair<std::size_t, Answer>> Ranks::Arrived(const Digest::Value& loop, bool wait) {
  std::unique_lock lock(mutex_);
  Loop& wanted = loops_[loop];
  // The count is set where this rank has begun the loop.
  while (wait && wanted.arrived.empty() && wanted.done < wanted.count && !(rank_ == 0 && Stopped()))
    arrived_.wait_for(lock, kLookAtInterrupt);
  return std::exchange(wanted.arrived, {});
}

void Ranks::End(const Digest::Value& loop) {
  const std::lock_guard lock(mutex_);
  // Rank 0 still has to say to those who come late that nothing is left.
  if (rank_ != 0) loops_.erase(loop);
}

void Ranks::Send(int to, const Message& message) {
  const std::lock_guard lock(mutex_);
  Post(to, ToBytes(message));
}

std::optional<Ranks::Received> Ranks::Await() {
  std::unique_lock lock(mutex_);
  if (received_.empty()) arrived_.wait_for(lock, kLookAtInterrupt);
  if (received_.empty()) return {};
  Received found = std::move(received_.front());
  received_.pop_front();
  return found;
}

}  // namespace sinew
