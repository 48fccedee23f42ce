#include "base/error.h"

namespace kerf {

std::string to_string(const Complaint& c) {
  std::string text;
  if (!c.file.empty())
    text += c.file + (c.line > 0 ? ":" + std::to_string(c.line) : "") + ": ";
  if (!c.path.empty())
    text += c.path + (c.value.empty() ? "" : " = '" + c.value + "'") + ": ";
  else if (!c.value.empty())
    text += "'" + c.value + "': ";
  text += c.rule;
  if (!c.remedy.empty())
    text += ". " + c.remedy;
  return text.ends_with('.') || text.ends_with('?') ? text : text + ".";
}

} // namespace kerf
