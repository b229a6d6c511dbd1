// SPDX-License-Identifier: BSD-3-Clause
#include "cli/help/manual.h"

#include <algorithm>
#include <cctype>

#include "cli/help/help.h"
#include "cli/help/tree.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/version.h"

namespace slamdb::cli {
namespace {

std::string PageTitle(const CLI::App& app) {
  std::string title = FullName(app);
  std::replace(title.begin(), title.end(), ' ', '-');
  return title;
}

// Text that roff prints as it stands: no escapes, no requests at the start of a line.
std::string Escaped(std::string_view text) {
  std::string out;
  bool line_start = true;
  for (const char c : text) {
    if (line_start && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
    line_start = c == '\n';
  }
  return out;
}

std::string Bold(std::string_view text) { return "\\fB" + Escaped(text) + "\\fR"; }
std::string Italic(std::string_view text) { return "\\fI" + Escaped(text) + "\\fR"; }

// Paragraphs between empty lines; lines that start with a space are set as they are.
std::string Paragraphs(std::string_view text) {
  std::string out;
  bool fresh = true, literal = false, paragraph_due = false;
  while (!text.empty()) {
    const std::string_view line = detail::TakeLine(text);
    const bool is_literal = line.starts_with(' ');
    if (literal && !is_literal) out += ".EE\n";
    if (is_literal && !literal) out += fresh ? ".EX\n" : ".PP\n.EX\n";
    if (line.empty()) {
      paragraph_due = !fresh;
    } else {
      if (!is_literal && (paragraph_due || literal)) out += ".PP\n";
      out += Escaped(line) + "\n";
      paragraph_due = fresh = false;
    }
    literal = is_literal;
  }
  return literal ? out + ".EE\n" : out;
}

std::string OptionHeading(const OptionEntry& entry) {
  std::string text;
  for (const std::string& name : entry.names) text += (text.empty() ? "" : ", ") + Bold(name);
  if (!entry.value.empty()) text += (text.empty() ? "" : " ") + Italic(entry.value);
  return entry.positional() && entry.repeated ? text + "..." : text;
}

std::string OptionParagraph(const OptionEntry& entry) {
  std::string text = ".TP\n" + OptionHeading(entry) + "\n" + Escaped(entry.description);
  if (!entry.choices.empty()) {
    text += ": ";
    for (const std::string& choice : entry.choices)
      text += (&choice == entry.choices.data() ? "" : ", ") + Bold(choice);
  }
  if (!entry.default_text.empty()) text += " (default " + Bold(entry.default_text) + ")";
  return text + ".\n";
}

std::string OptionsSection(const CLI::App& app) {
  std::string text, heading;
  for (const OptionEntry& entry : OptionsOf(app)) {
    const std::string group = entry.positional() ? "Arguments" : entry.group;
    if (group != heading) text += ".SS " + Escaped(group) + "\n";
    heading = group;
    text += OptionParagraph(entry);
  }
  return text;
}

std::string SynopsisLine(const CLI::App& app) {
  const std::string name = FullName(app), rest = Synopsis(app).substr(name.size());
  return Bold(name) + Escaped(rest) + "\n";
}

std::string VerbsSection(const CLI::App& app, bool with_options) {
  std::string text;
  for (const CLI::App* verb : VerbsOf(app)) {
    if (with_options) {
      text += ".SH " + Escaped(FullName(*verb)) + "\n" + SynopsisLine(*verb) + ".PP\n" +
              Escaped(verb->get_description()) + ".\n" + OptionsSection(*verb);
    } else {
      text += ".TP\n" + Bold(verb->get_name()) + "\n" + Escaped(verb->get_description()) + ".\n";
    }
  }
  return text;
}

std::string ExitSection(const Command& command) {
  std::string text = ".SH EXIT STATUS\n";
  for (const auto& [code, meaning] : ExitCodesOf(command))
    text += ".TP\n" + Bold(std::to_string(static_cast<int>(code))) + "\n" + Escaped(meaning) + "\n";
  return text;
}

std::string ExamplesSection(const Command& command) {
  std::string text = ".SH EXAMPLES\n";
  for (const Example& example : command.examples)
    text += ".TP\n" + Bold(example.command) + "\n" + Escaped(example.meaning) + "\n";
  return text;
}

std::string SeeAlso(const CLI::App& app) {
  if (app.get_parent() != nullptr) return ".SH SEE ALSO\n.BR slamdb (1)\n";
  std::string text = ".SH SEE ALSO\n";
  const auto verbs = VerbsOf(app);
  for (const CLI::App* verb : verbs)
    text += ".BR " + Escaped(PageTitle(*verb)) + (verb == verbs.back() ? " (1)\n" : " (1),\n");
  return text;
}

constexpr std::string_view kProgramDescription =
    R"(slamdb opens, keeps, checks, converts and shows the maps that visual SLAM systems save, without the SLAM system.

Atlases are files (.osa of ORB-SLAM3, binary or text) or lie under a name in a store (STORE.db#NAME, an SQLite file, or
postgresql://USER@HOST/DATABASE#NAME, wherever a store is named). A password is best kept in ~/.pgpass; one in a URI is never shown.
Inputs are never changed, and no output may be one. Outputs are written beside their place and renamed when they are whole;
nothing is replaced without --overwrite, and a store never by a file. Devices and pipes are written into. The name - means standard input or output. Results go to standard output, everything else to
standard error.)";

constexpr std::string_view kProgramExits = R"(.SH EXIT STATUS
.TP
\fB0\fR
Done.
.TP
\fB1\fR
Failed, or findings of severity error.
.TP
\fB2\fR
The command line was wrong.
.TP
\fB3\fR
Done, but something of the input is not in the output; standard error names it.
.SH ENVIRONMENT
.TP
\fBNO_COLOR\fR
When set, nothing is coloured. Otherwise colours are used on terminals only, if
.B TERM
is not
.BR dumb ;
.B \-\-color
decides.
.TP
\fBCOLUMNS\fR
How wide help is. By default as the terminal is.
)";

}  // namespace

std::string ManualPage(const CLI::App& app) {
  const Command* command = CommandOf(app);
  std::string title = PageTitle(app);
  std::string upper = title;
  std::transform(upper.begin(), upper.end(), upper.begin(), [](unsigned char c) { return std::toupper(c); });
  std::string text = ".TH " + Escaped(upper) + " 1 " SLAMDB_MANUAL_DATE " \"slamdb " + std::string(Version()) +
                     "\" \"slamdb manual\"\n";
  text += ".SH NAME\n" + Escaped(title) + " \\- " + Escaped(app.get_description()) + "\n";
  text += ".SH SYNOPSIS\n" + SynopsisLine(app);
  text += ".SH DESCRIPTION\n" + Paragraphs(command == nullptr ? kProgramDescription : command->description);
  if (command == nullptr)
    return text + ".SH VERBS\n" + VerbsSection(app, false) + std::string(kProgramExits) + SeeAlso(app);
  const bool has_verbs = !VerbsOf(app).empty();
  text += has_verbs ? VerbsSection(app, true) : ".SH OPTIONS\n" + OptionsSection(app);
  return text + ExitSection(*command) + ExamplesSection(*command) + SeeAlso(app);
}

std::string ManualPageName(const CLI::App& app) { return PageTitle(app) + ".1"; }

}  // namespace slamdb::cli
