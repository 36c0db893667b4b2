// SPDX-License-Identifier: MIT
#include "hal/linux/v4l2/buffers.hpp"

#include <fcntl.h>
#include <linux/dma-buf.h>
#include <linux/dma-heap.h>
#include <linux/videodev2.h>
#include <sys/mman.h>

#include <algorithm>
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

/// The kernel's description of a buffer, with its one plane where the driver has planes.
struct OneBuffer {
  OneBuffer(const CaptureNode& node, std::uint32_t memory) {
    buffer.type = node.buffer_type();
    buffer.memory = memory;
    if (!node.in_planes()) return;
    buffer.m.planes = &plane;
    buffer.length = 1;
  }
  OneBuffer(const OneBuffer&) = delete;
  OneBuffer& operator=(const OneBuffer&) = delete;

  v4l2_plane plane{};
  v4l2_buffer buffer{};
};

}  // namespace

BufferSet& BufferSet::operator=(BufferSet&& other) noexcept {
  if (this != &other) {
    release();
    node_ = std::move(other.node_);
    memory_ = other.memory_;
    buffers_ = std::move(other.buffers_);
    other.buffers_.clear();
  }
  return *this;
}

std::uint32_t BufferSet::v4l2_memory() const {
  return memory_ == BufferMemory::Mapped ? V4L2_MEMORY_MMAP : V4L2_MEMORY_DMABUF;
}

Result<BufferSet> BufferSet::create(const CaptureNode& node, const BufferRequest& request) {
  BufferSet set;
  set.node_ = node;
  set.memory_ = request.memory;
  Descriptor heap;
  if (request.memory == BufferMemory::DmaBuf) {
    BITELINE_ASSIGN(heap, open_device(request.heap.c_str(), O_RDWR));
  }
  v4l2_requestbuffers wanted{};
  wanted.count = request.count;
  wanted.type = node.buffer_type();
  wanted.memory = set.v4l2_memory();
  if (retrying_ioctl(node.device(), VIDIOC_REQBUFS, &wanted) < 0)
    return capture_failure(errno, node.name(), "request buffers");
  for (std::uint32_t i = 0; i < wanted.count; ++i) {
    BITELINE_TRY(heap.is_open() ? set.take_from_heap(heap, request) : set.map_drivers_own(i));
  }
  return set;
}

Result<void> BufferSet::map_drivers_own(std::uint32_t index) {
  OneBuffer one{node_, V4L2_MEMORY_MMAP};
  one.buffer.index = index;
  if (retrying_ioctl(node_.device(), VIDIOC_QUERYBUF, &one.buffer) < 0)
    return capture_failure(errno, node_.name(), "query buffer");
  const bool in_planes = node_.in_planes();
  const std::size_t size_bytes = in_planes ? one.plane.length : one.buffer.length;
  const std::int64_t offset_bytes = in_planes ? one.plane.m.mem_offset : one.buffer.m.offset;
  BITELINE_ASSIGN(const std::span<std::uint8_t> bytes, map_shared(node_.device(), size_bytes, offset_bytes));
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
  OneBuffer one{node_, v4l2_memory()};
  one.buffer.index = static_cast<std::uint32_t>(index);
  const auto size_bytes = static_cast<std::uint32_t>(buffers_[index].bytes.size());
  const int dma_buf = memory_ == BufferMemory::DmaBuf ? buffers_[index].dma_buf.number() : 0;
  if (node_.in_planes()) {
    one.plane.length = size_bytes;
    if (memory_ == BufferMemory::DmaBuf) one.plane.m.fd = dma_buf;
  } else {
    one.buffer.length = size_bytes;
    if (memory_ == BufferMemory::DmaBuf) one.buffer.m.fd = dma_buf;
  }
  if (retrying_ioctl(node_.device(), VIDIOC_QBUF, &one.buffer) < 0)
    return capture_failure(errno, node_.name(), "queue buffer");
  return {};
}

Result<v4l2_buffer> BufferSet::dequeue(std::size_t& begin_bytes) const {
  OneBuffer one{node_, v4l2_memory()};
  begin_bytes = 0;
  if (retrying_ioctl(node_.device(), VIDIOC_DQBUF, &one.buffer) < 0) {
    // EIO: the driver gave up on the stream (videobuf2: queue in error); only a new start helps.
    if (errno == EAGAIN) return fail(Errc::Timeout, "%.100s", node_.name().c_str());
    return device_failure(errno, node_.name().c_str(), "dequeue buffer");
  }
  if (one.buffer.index >= buffers_.size())
    return fail(Errc::DeviceError, "%.100s: gives a buffer that it was not given", node_.name().c_str());
  if (node_.in_planes()) {
    begin_bytes = std::min<std::size_t>(one.plane.data_offset, buffers_[one.buffer.index].bytes.size());
    // The planes' count of bytes has those before the picture in it.
    one.buffer.bytesused = one.plane.bytesused - std::min(one.plane.data_offset, one.plane.bytesused);
    one.buffer.m.planes = nullptr;
  }
  return one.buffer;
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
  none.type = node_.buffer_type();
  none.memory = v4l2_memory();
  // Fails when the camera is gone, and then there is nothing left to give back.
  static_cast<void>(retrying_ioctl(node_.device(), VIDIOC_REQBUFS, &none));
}

}  // namespace biteline::hal
