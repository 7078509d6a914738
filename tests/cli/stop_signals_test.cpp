#include "cli/stop_signals.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <string>
#include <thread>

namespace sinew {
namespace {

using std::chrono::milliseconds;
using testing::ExitedWithCode;

// Each in a process of its own (a death test): the signals end it.

void Raise(int signal) {
  kill(getpid(), signal);
}

TEST(StopSignalsDeathTest, EndWorkThatCannotBeStopped) {
  const auto work = [](int signal) {
    const StopSignals signals("prog");
    StoppableWork stoppable([] { return std::string("; f.h5 holds it"); });
    Raise(signal);
    std::this_thread::sleep_for(milliseconds(10000));
  };
  const auto began = std::chrono::steady_clock::now();
  EXPECT_EXIT(work(SIGTERM), ExitedWithCode(143), "^prog: stopped by SIGTERM; f.h5 holds it\n$");
  EXPECT_EXIT(work(SIGINT), ExitedWithCode(130), "^prog: stopped by SIGINT; f.h5 holds it\n$");
  EXPECT_LT(std::chrono::steady_clock::now() - began, milliseconds(5 * 1000))
      << "1.2 s on a machine that does nothing else";
}

TEST(StopSignalsDeathTest, LeaveWorkThatEndsInOrder) {
  const auto work = [] {
    const StopSignals signals("prog");
    int status = 0;
    {
      StoppableWork stoppable([] { return std::string("; not this"); });
      Raise(SIGTERM);
      while (!InterruptFlag()) std::this_thread::sleep_for(milliseconds(1));
      status = stoppable.Finish();
      std::this_thread::sleep_for(milliseconds(1000));  // writes what it has found
    }
    std::this_thread::sleep_for(milliseconds(10));
    std::exit(status);
  };
  EXPECT_EXIT(work(), ExitedWithCode(143), "^$");
}

TEST(StopSignalsDeathTest, EndOtherCommandsAtOnce) {
  const auto work = [] {
    const StopSignals signals("prog");
    Raise(SIGTERM);
    std::this_thread::sleep_for(milliseconds(10000));
  };
  EXPECT_EXIT(work(), ExitedWithCode(143), "^prog: stopped by SIGTERM before its end: begin it again\n$");
}

TEST(StopSignalsDeathTest, TheSecondEndsAtOnce) {
  const auto work = [] {
    const StopSignals signals("prog");
    StoppableWork stoppable([] { return std::string("; not this"); });
    Raise(SIGINT);
    while (!InterruptFlag()) std::this_thread::sleep_for(milliseconds(1));
    stoppable.Finish();
    std::this_thread::sleep_for(milliseconds(400));
    Raise(SIGINT);
    std::this_thread::sleep_for(milliseconds(10000));
  };
  EXPECT_EXIT(
      work(), ExitedWithCode(130),
      "^prog: stopped by SIGINT at the second signal: what was found since the last checkpoint is not "
      "kept\n$");
}

TEST(StopSignalsDeathTest, OneRequestThatArrivesTwiceIsOne) {
  const auto work = [] {
    const StopSignals signals("prog");
    StoppableWork stoppable([] { return std::string("; f.h5 holds it"); });
    Raise(SIGTERM);
    while (!InterruptFlag()) std::this_thread::sleep_for(milliseconds(1));
    Raise(SIGTERM);
    std::this_thread::sleep_for(milliseconds(10000));
  };
  EXPECT_EXIT(work(), ExitedWithCode(143), "^prog: stopped by SIGTERM; f.h5 holds it\n$");
}

TEST(StopSignalsDeathTest, ThatAreIgnoredStayIgnored) {
  const auto work = [] {
    std::signal(SIGINT, SIG_IGN);
    const StopSignals signals("prog");
    Raise(SIGINT);
    std::this_thread::sleep_for(milliseconds(100));
    std::exit(InterruptFlag() ? 1 : 0);
  };
  EXPECT_EXIT(work(), ExitedWithCode(0), "^$");
}

TEST(StopSignalsDeathTest, PassTheSignalOn) {
  const auto work = [] {
    const StopSignals signals("prog");
    StoppableWork stoppable([] { return std::string(); }, [](int signal) { _exit(signal); });
    Raise(SIGTERM);
    std::this_thread::sleep_for(milliseconds(10000));
  };
  EXPECT_EXIT(work(), ExitedWithCode(SIGTERM), "^$");
}

}  // namespace
}  // namespace sinew
