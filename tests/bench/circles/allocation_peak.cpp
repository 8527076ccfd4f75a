#include "bench/circles/allocation_peak.hpp"

#include <malloc.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>

namespace berth::bench {
namespace {

thread_local long long held = 0, worst = 0;

#ifndef BERTH_SANITIZED
void* count(void* block) {
  if (block) held += static_cast<long long>(malloc_usable_size(block));
  worst = std::max(worst, held);
  return block;
}

void discount(void* block) {
  if (block) held -= static_cast<long long>(malloc_usable_size(block));
}
#endif

}  // namespace

AllocationPeak::AllocationPeak() : start_(held) { worst = held; }

std::size_t AllocationPeak::bytes() const { return static_cast<std::size_t>(worst - start_); }

}  // namespace berth::bench

#ifndef BERTH_SANITIZED
// glibc's own, under the names that it keeps for programs that replace malloc.
extern "C" {
void* __libc_malloc(std::size_t);
void __libc_free(void*);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) { return berth::bench::count(__libc_malloc(size)); }
void* calloc(std::size_t n, std::size_t size) {
  return berth::bench::count(__libc_calloc(n, size));
}
void* memalign(std::size_t alignment, std::size_t size) {
  return berth::bench::count(__libc_memalign(alignment, size));
}
void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  *block = memalign(alignment, size);
  return *block ? 0 : ENOMEM;
}
void* realloc(void* block, std::size_t size) {
  berth::bench::discount(block);
  return berth::bench::count(__libc_realloc(block, size));
}
void free(void* block) {
  berth::bench::discount(block);
  __libc_free(block);
}
}
#endif
