// All states that a document has been in, one an action, and where in them it is.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "app/edit/document/document.h"

namespace ecorche {

struct HistoryStep {
  Document document;
  std::string line;  // of the action that led to it; empty for the first
};

struct History {
  std::vector<HistoryStep> steps;  // never empty once begun
  std::size_t now = 0;
};

History begin_history(Document document);
const Document& document_now(const History& history);
// Forgets what was undone before.
void add_step(History& history, Document document, std::string line);
// As many steps as there are, at most `steps`; returns how many.
int undo_steps(History& history, int steps);
int redo_steps(History& history, int steps);

}  // namespace ecorche
