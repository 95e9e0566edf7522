#include "reconstruct/poisson/dct.h"

#include <cmath>
#include <mutex>
#include <new>
#include <numbers>

#include <fftw3.h>

namespace gradus::reconstruct {
namespace {

// FFTW's planner is not thread-safe; executing plans is.
std::mutex& planner_mutex() {
  static std::mutex mutex;
  return mutex;
}

FftBuffer allocate(int length) {
  auto* p = reinterpret_cast<std::complex<float>*>(fftwf_malloc(sizeof(fftwf_complex) * size_t(length)));
  if (!p) throw std::bad_alloc();
  return FftBuffer(p);
}

fftwf_complex* fftw(const FftBuffer& buffer) { return reinterpret_cast<fftwf_complex*>(buffer.get()); }

}  // namespace

void FftwFree::operator()(void* p) const { fftwf_free(p); }

Dct::Scratch::Scratch(int length) : time(allocate(length)), frequency(allocate(length)) {}

Dct::Dct(int length) : length_(length), twiddle_(size_t(length)) {
  for (int k = 0; k < length; ++k) {
    const double angle = -std::numbers::pi * k / (2.0 * length);
    twiddle_[k] = {float(std::cos(angle)), float(std::sin(angle))};
  }
  const Scratch scratch(length);
  const std::lock_guard lock(planner_mutex());
  // FFTW_ESTIMATE, because measured plans take seconds to make and differ from run to run, and with them the last bits
  // of the result.
  forward_ = fftwf_plan_dft_1d(length, fftw(scratch.time), fftw(scratch.frequency), FFTW_FORWARD, FFTW_ESTIMATE);
  backward_ = fftwf_plan_dft_1d(length, fftw(scratch.frequency), fftw(scratch.time), FFTW_BACKWARD, FFTW_ESTIMATE);
  if (!forward_ || !backward_) throw std::bad_alloc();
}

Dct::~Dct() {
  const std::lock_guard lock(planner_mutex());
  fftwf_destroy_plan(forward_);
  fftwf_destroy_plan(backward_);
}

void Dct::forward(float* a, float* b, Scratch* scratch) const {
  const int n = length_;
  std::complex<float>* const z = scratch->time.get();
  for (int i = 0; 2 * i < n; ++i) z[i] = {a[2 * i], b[2 * i]};
  for (int i = 0; 2 * i + 1 < n; ++i) z[n - 1 - i] = {a[2 * i + 1], b[2 * i + 1]};
  fftwf_execute_dft(forward_, fftw(scratch->time), fftw(scratch->frequency));

  const std::complex<float>* const f = scratch->frequency.get();
  a[0] = 2.0f * f[0].real();
  b[0] = 2.0f * f[0].imag();
  for (int k = 1; 2 * k <= n; ++k) {
    const float pr = f[k].real(), pi = f[k].imag(), qr = f[n - k].real(), qi = f[n - k].imag();
    const float wr = twiddle_[k].real(), wi = twiddle_[k].imag();
    // 2V of both rows, separated by the symmetry of a real row's transform.
    const float ar = pr + qr, ai = pi - qi, br = pi + qi, bi = qr - pr;
    // Written in this order so that for k = n - k both agree.
    a[n - k] = -(wr * ai + wi * ar);
    b[n - k] = -(wr * bi + wi * br);
    a[k] = wr * ar - wi * ai;
    b[k] = wr * br - wi * bi;
  }
}

void Dct::inverse(float* a, float* b, Scratch* scratch) const {
  const int n = length_;
  std::complex<float>* const f = scratch->frequency.get();
  f[0] = {0.5f * a[0], 0.5f * b[0]};
  for (int k = 1; 2 * k <= n; ++k) {
    const float wr = 0.5f * twiddle_[k].real(), wi = 0.5f * twiddle_[k].imag();
    // V = conj(w) (X[k] - i X[n-k]) / 2
    const float ar = wr * a[k] - wi * a[n - k], ai = -wr * a[n - k] - wi * a[k];
    const float br = wr * b[k] - wi * b[n - k], bi = -wr * b[n - k] - wi * b[k];
    f[n - k] = {ar + bi, br - ai};  // conj(Va) + i conj(Vb)
    f[k] = {ar - bi, ai + br};      // Va + i Vb
  }
  fftwf_execute_dft(backward_, fftw(scratch->frequency), fftw(scratch->time));
  const std::complex<float>* const z = scratch->time.get();
  for (int i = 0; 2 * i < n; ++i) {
    a[2 * i] = z[i].real();
    b[2 * i] = z[i].imag();
  }
  for (int i = 0; 2 * i + 1 < n; ++i) {
    a[2 * i + 1] = z[n - 1 - i].real();
    b[2 * i + 1] = z[n - 1 - i].imag();
  }
}

void Dct::filter(const float* gain_a, const float* gain_b, double sum_a, Scratch* scratch) const {
  const int n = length_;
  fftwf_execute_dft(forward_, fftw(scratch->time), fftw(scratch->frequency));
  std::complex<float>* const f = scratch->frequency.get();
  f[0] = {gain_a[0] * (std::isnan(sum_a) ? f[0].real() : static_cast<float>(sum_a)), gain_b[0] * f[0].imag()};
  for (int k = 1; 2 * k <= n; ++k) {
    const float pr = f[k].real(), pi = f[k].imag(), qr = f[n - k].real(), qi = f[n - k].imag();
    const float wr = twiddle_[k].real(), wi = twiddle_[k].imag();
    // The same arithmetic as in forward().
    float ar = pr + qr, ai = pi - qi, br = pi + qi, bi = qr - pr;
    const float ak = gain_a[k] * (wr * ar - wi * ai), an = -gain_a[n - k] * (wr * ai + wi * ar);
    const float bk = gain_b[k] * (wr * br - wi * bi), bn = -gain_b[n - k] * (wr * bi + wi * br);
    // The same arithmetic as in inverse().
    ar = wr * ak - wi * an, ai = -wr * an - wi * ak;
    br = wr * bk - wi * bn, bi = -wr * bn - wi * bk;
    f[n - k] = {0.5f * (ar + bi), 0.5f * (br - ai)};
    f[k] = {0.5f * (ar - bi), 0.5f * (ai + br)};
  }
  fftwf_execute_dft(backward_, fftw(scratch->frequency), fftw(scratch->time));
}

}  // namespace gradus::reconstruct
