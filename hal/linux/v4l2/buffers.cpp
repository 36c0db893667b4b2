// SPDX-License-Identifier: MIT
#include "hal/linux/v4l2/buffers.hpp"

#include <fcntl.h>
#include <linux/dma-buf.h>
#include <linux/dma-heap.h>
#include <linux/videodev2.h>
#include <sys/mman.h>

#include <cerrno>

namespace biteline::hal {
namespace {

Result<std::span<std::uint8_t>> map_shared(int descriptor, std::size_t size_bytes,
                                           std::int64_t offset_bytes) {
  void* const address =
      ::mmap(nullptr, size_bytes, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, offset_bytes);
  if (address == MAP_FAILED) return device_failure(errno, "camera", "map buffer");
  return std::span{static_cast<std::uint8_t*>(address), size_bytes};
}

}  // namespace

BufferSet& BufferSet::operator=(BufferSet&& other) noexcept {
  if (this != &other) {
    release();
    device_ = other.device_;
    memory_ = other.memory_;
    buffers_ = std::move(other.buffers_);
    other.buffers_.clear();
  }
  return *this;
}

std::uint32_t BufferSet::v4l2_memory() const {
  return memory_ == BufferMemory::Mapped ? V4L2_MEMORY_MMAP : V4L2_MEMORY_DMABUF;
}

Result<BufferSet> BufferSet::create(int device, const BufferRequest& request) {
  BufferSet set;
  set.device_ = device;
  set.memory_ = request.memory;
  Descriptor heap;
  if (request.memory == BufferMemory::DmaBuf) {
    BITELINE_ASSIGN(heap, open_device(request.heap.c_str(), O_RDWR));
  }
  v4l2_requestbuffers wanted{};
  wanted.count = request.count;
  wanted.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  wanted.memory = set.v4l2_memory();
  if (retrying_ioctl(device, VIDIOC_REQBUFS, &wanted) < 0)
    return device_failure(errno, "camera", "request buffers");
  for (std::uint32_t i = 0; i < wanted.count; ++i) {
    BITELINE_TRY(heap.is_open() ? set.take_from_heap(heap, request) : set.map_drivers_own(i));
  }
  return set;
}

Result<void> BufferSet::map_drivers_own(std::uint32_t index) {
  v4l2_buffer buffer{};
  buffer.index = index;
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  if (retrying_ioctl(device_, VIDIOC_QUERYBUF, &buffer) < 0)
    return device_failure(errno, "camera", "query buffer");
  BITELINE_ASSIGN(const std::span<std::uint8_t> bytes, map_shared(device_, buffer.length, buffer.m.offset));
  buffers_.push_back({.bytes = bytes, .dma_buf = {}});
  return {};
}

Result<void> BufferSet::take_from_heap(const Descriptor& heap, const BufferRequest& request) {
  dma_heap_allocation_data allocation{};
  allocation.len = request.size_bytes;
  allocation.fd_flags = O_RDWR | O_CLOEXEC;
  if (retrying_ioctl(heap.number(), DMA_HEAP_IOCTL_ALLOC, &allocation) < 0) {
    return device_failure(errno, request.heap.c_str(), "allocate");
  }
  Descriptor dma_buf{static_cast<int>(allocation.fd)};
  BITELINE_ASSIGN(const std::span<std::uint8_t> bytes, map_shared(dma_buf.number(), request.size_bytes, 0));
  buffers_.push_back({.bytes = bytes, .dma_buf = std::move(dma_buf)});
  return {};
}

Result<void> BufferSet::queue(std::size_t index) const {
  v4l2_buffer buffer{};
  buffer.index = static_cast<std::uint32_t>(index);
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = v4l2_memory();
  buffer.length = static_cast<std::uint32_t>(buffers_[index].bytes.size());
  if (memory_ == BufferMemory::DmaBuf) buffer.m.fd = buffers_[index].dma_buf.number();
  if (retrying_ioctl(device_, VIDIOC_QBUF, &buffer) < 0)
    return device_failure(errno, "camera", "queue buffer");
  return {};
}

void BufferSet::begin_reading(std::size_t index) const {
  if (memory_ != BufferMemory::DmaBuf) return;
  dma_buf_sync sync{.flags = DMA_BUF_SYNC_START | DMA_BUF_SYNC_READ};
  static_cast<void>(retrying_ioctl(buffers_[index].dma_buf.number(), DMA_BUF_IOCTL_SYNC, &sync));
}

void BufferSet::end_reading(std::size_t index) const {
  if (memory_ != BufferMemory::DmaBuf) return;
  dma_buf_sync sync{.flags = DMA_BUF_SYNC_END | DMA_BUF_SYNC_READ};
  static_cast<void>(retrying_ioctl(buffers_[index].dma_buf.number(), DMA_BUF_IOCTL_SYNC, &sync));
}

void BufferSet::release() noexcept {
  if (buffers_.empty()) return;
  for (const Buffer& buffer : buffers_) ::munmap(buffer.bytes.data(), buffer.bytes.size());
  buffers_.clear();
  v4l2_requestbuffers none{};
  none.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  none.memory = v4l2_memory();
  // Fails when the camera is gone, and then there is nothing left to give back.
  static_cast<void>(retrying_ioctl(device_, VIDIOC_REQBUFS, &none));
}

}  // namespace biteline::hal
