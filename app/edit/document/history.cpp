#include "app/edit/document/history.h"

#include <algorithm>

namespace ecorche {

History begin_history(Document document) {
  History out;
  out.steps.push_back({std::move(document), {}});
  return out;
}

const Document& document_now(const History& history) { return history.steps[history.now].document; }

void add_step(History& history, Document document, std::string line) {
  history.steps.resize(history.now + 1);
  history.steps.push_back({std::move(document), std::move(line)});
  ++history.now;
}

int undo_steps(History& history, int steps) {
  const int done = std::min(steps, int(history.now));
  history.now -= std::size_t(done);
  return done;
}

int redo_steps(History& history, int steps) {
  const int done = std::min(steps, int(history.steps.size() - 1 - history.now));
  history.now += std::size_t(done);
  return done;
}

}  // namespace ecorche
