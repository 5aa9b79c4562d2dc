// A list that grows at its end, and whose copies share all that they have in common: a copy is a pointer. An
// item must hold no chain of items of its own type.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>

namespace lobe {

template <class T>
class SharedChain {
 public:
  bool empty() const { return !last_; }
  std::size_t size() const { return last_ ? last_->size : 0; }
  const T& back() const { return last_->item; }
  void push_back(T item) {
    const std::size_t size = this->size() + 1;
    last_ = std::make_shared<const Link>(std::move(item), size, std::move(last_));
  }
  void pop_back() { last_ = std::shared_ptr<const Link>(last_->before); }
  // Visits all items from the last to the first, until visit(item) returns false.
  template <class Visit>
  void visit_backwards(Visit&& visit) const {
    for (const Link* link = last_.get(); link && visit(link->item); link = link->before.get()) {
    }
  }

 private:
  struct Link {
    Link(T one, std::size_t count, std::shared_ptr<const Link> previous)
        : item(std::move(one)), size(count), before(std::move(previous)) {}
    Link(const Link&) = delete;
    Link& operator=(const Link&) = delete;
    // One after the other: links that ended each other would fill the stack.
    ~Link() {
      thread_local std::shared_ptr<const Link>* next = nullptr;  // next link, for the thread's loop
      if (next) {
        *next = std::move(before);
        return;
      }
      std::shared_ptr<const Link> link = std::move(before);
      while (link) {
        std::shared_ptr<const Link> following;
        next = &following;
        link.reset();
        link = std::move(following);
      }
      next = nullptr;
    }

    T item;
    std::size_t size;
    std::shared_ptr<const Link> before;
  };

  std::shared_ptr<const Link> last_;
};

}  // namespace lobe
