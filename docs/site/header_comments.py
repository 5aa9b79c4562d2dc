"""Gives Doxygen the comments of a header: `// text` above a declaration, or beside it, is its description.

The namespace `lobe` goes: Doxygen lists the functions of a header only where they are in none. So do
declarations of enumerations without their values.
"""
import re

CODE_COMMENT = re.compile(r"^(.*\S)(\s+)//(?!/)\s?(.*)$")
LINE_COMMENT = re.compile(r"^(\s*)//(?!/)\s?(.*)$")
NAMESPACE = re.compile(r"^(namespace lobe(::io)? \{|\}  // namespace lobe(::io)?|enum class \w+ : [\w:]+;.*)$")
IS_QUOTED = re.compile(r'"[^"]*$')


def escaped(text):
    """Comments are plain text: what Doxygen or XML would take for a command is kept as it is."""
    return re.sub(r"([@\\<>#&])", r"\\\1", text)


def filtered(lines, name):
    beside = None  # column of the comment beside the line before
    is_first = True
    for line in lines:
        line = line.rstrip("\n")
        if NAMESPACE.match(line):
            beside = None
            yield ""
            continue
        alone = LINE_COMMENT.match(line)
        after = None if alone else CODE_COMMENT.match(line)
        if alone:
            column = len(alone[1])
            if beside == column:
                yield f"{alone[1]}///< {escaped(alone[2])}"
                continue
            beside = None
            start = f"/// \\file {name}\n" if is_first else ""
            is_first = False
            yield f"{start}{alone[1]}/// {escaped(alone[2])}"
        elif after and not IS_QUOTED.search(after[1].replace('\\"', "")):
            beside = len(after[1]) + len(after[2])
            yield f"{after[1]}{after[2]}///< {escaped(after[3])}"
        else:
            beside = None
            yield line
