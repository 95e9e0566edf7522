// Discrete cosine transforms of pairs of real rows: two rows are the real and imaginary part of one complex Fourier
// transform.
#pragma once

#include <complex>
#include <limits>
#include <memory>
#include <vector>

struct fftwf_plan_s;

namespace gradus::reconstruct {

struct FftwFree {
  void operator()(void* p) const;
};
// Memory as FFTW wants it for its vector code.
using FftBuffer = std::unique_ptr<std::complex<float>[], FftwFree>;

// X[k] = 2 Σ x[n] cos(π (2n+1) k / 2N) and its inverse without the factor 1/N, both in place (DCT-II and -III; Makhoul
// 1980, "A fast cosine transform in one and two dimensions": the even samples, then the odd ones backwards, by one
// Fourier transform of the same length).
class Dct {
 public:
  // Scratch of one thread.
  struct Scratch {
    explicit Scratch(int length);
    FftBuffer time, frequency;
  };

  explicit Dct(int length);
  ~Dct();
  Dct(const Dct&) = delete;
  Dct& operator=(const Dct&) = delete;

  int length() const { return length_; }
  // Any number of threads, each with its own scratch.
  void forward(float* a, float* b, Scratch* scratch) const;
  void inverse(float* a, float* b, Scratch* scratch) const;

  // Where x[i] of a pair lies in scratch->time.
  int place(int i) const { return i % 2 == 0 ? i / 2 : length_ - 1 - i / 2; }
  // Forth, times gain_a[k] and gain_b[k], and back, of what lies in scratch->time. sum_a: Σx of a where it is known
  // better than by sums of floats, or kUnknownSum.
  static constexpr double kUnknownSum = std::numeric_limits<double>::quiet_NaN();
  void filter(const float* gain_a, const float* gain_b, double sum_a, Scratch* scratch) const;

 private:
  int length_;
  std::vector<std::complex<float>> twiddle_;  // exp(-iπk/2N)
  fftwf_plan_s* forward_ = nullptr;
  fftwf_plan_s* backward_ = nullptr;
};

}  // namespace gradus::reconstruct
