#include "render/render_task.h"

#include <algorithm>
#include <chrono>

#include "base/fault.h"
#include "base/fpu.h"

namespace gradus::render {

void RenderTask::run() noexcept {
  try {
    const FlushDenormals flush;
    render();
    end(GRADUS_OK, "");
  } catch (const Error& e) {
    end(e.code(), e.what());
  } catch (const std::bad_alloc&) {
    end(GRADUS_ERROR_OUT_OF_MEMORY, "out of memory while rendering");
  } catch (const std::exception& e) {
    end(GRADUS_FAULT(render_thread_swallows_exception) ? GRADUS_OK : GRADUS_ERROR_UNKNOWN, e.what());
  } catch (...) {
    end(GRADUS_ERROR_UNKNOWN, "unknown exception while rendering");
  }
}

void RenderTask::end(GradusError code, const std::string& text) noexcept {
  try {
    const std::lock_guard lock(mutex_);
    total_seconds_ = seconds();
    code_ = code;
    phase_ = code == GRADUS_OK                ? GRADUS_PHASE_DONE
             : code == GRADUS_ERROR_CANCELLED ? GRADUS_PHASE_CANCELLED
                                              : GRADUS_PHASE_FAILED;
    ending(code);
    if (code == GRADUS_OK) tracker_.raise_to(1.0f);
    tracker_.new_image();
    text_ = text;
  } catch (...) {  // only the copy of the text can throw, and the phase is already set
  }
  ended_.notify_all();
}

bool RenderTask::wait(double seconds) const {
  std::unique_lock lock(mutex_);
  const auto ended = [this] { return is_ended(); };
  // Longer waits have no limit, because they would overflow the clock.
  if (!(seconds >= 0.0) || seconds > 1e8) {
    ended_.wait(lock, ended);
    return true;
  }
  return ended_.wait_for(lock, std::chrono::duration<double>(seconds), ended);
}

GradusProgress RenderTask::progress() const {
  GradusProgress p{};
  p.struct_size = sizeof(p);
  p.seconds = static_cast<float>(seconds());
  p.samples_done = tracker_.samples();
  p.version = tracker_.version();
  p.fraction = tracker_.fraction();
  p.peak_memory_bytes = peak_memory_bytes();
  const std::lock_guard lock(mutex_);
  p.phase = phase_;
  if (is_ended()) {
    p.fraction = tracker_.fraction();
    p.seconds = static_cast<float>(total_seconds_);
  }
  p.memory_bytes = memory_bytes();
  return p;
}

GradusError RenderTask::outcome(std::string* text) const {
  const std::lock_guard lock(mutex_);
  require_end("its outcome comes");
  if (text) *text = text_;
  return code_;
}

void RenderTask::require_end(const char* what) const {
  if (!is_ended()) throw invalid_operation(std::string("the render is still running: ") + what + " at the end");
}

void RenderTask::require_film(const std::shared_ptr<const film::Film>& film, const char* what,
                              const char* failure) const {
  require_end(what);
  if (!film) throw invalid_operation(failure + text_);
}

}  // namespace gradus::render
