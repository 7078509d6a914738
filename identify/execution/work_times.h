// Processor seconds of the pieces of independent work, from which it can be told how much faster more
// processors would do it.
#pragma once

#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

namespace sinew {

/// Times of pieces count the thread that does them alone: they are whole if the program has one thread.
class WorkTimes {
 public:
  struct Loop {
    std::vector<double> pieces;  ///< [s] those that this process did itself; NaN: another one did
    double began = 0;            ///< [s] of processor time that the process had taken by then
    double ended = 0;            ///< [s]
    double repeated = 0;         ///< [s] for taking over the pieces that others did
  };

  std::size_t Begin(std::size_t pieces);
  void SetPiece(std::size_t loop, std::size_t piece, double seconds);
  void End(std::size_t loop, double repeated);
  [[nodiscard]] std::vector<Loop> loops() const;

  /// [s] of processor time of the whole process, of this thread
  static double OfProcess();
  static double OfThread();

 private:
  mutable std::mutex mutex_;
  std::vector<Loop> loops_;
};

}  // namespace sinew
