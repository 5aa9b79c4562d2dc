// Other programs, where the system is Windows.
#define NOMINMAX
#define WIN32_LEAN_AND_MEAN
#include <windows.h>

#include <process.h>
#include <shellapi.h>

#include <cstdio>
#include <cstdlib>
#include <memory>

#include "console.h"

namespace lobe::program {
namespace {

// So that CommandLineToArgvW() reads the same word back: backslashes before a quotation mark count twice.
std::wstring quoted(const std::wstring& word) {
  if (!word.empty() && word.find_first_of(L" \t\"") == std::wstring::npos) return word;
  std::wstring text = L"\"";
  std::size_t backslashes = 0;  // just before this character
  for (const wchar_t character : word) {
    if (character == L'"') text.append(backslashes + 1, L'\\');
    backslashes = character == L'\\' ? backslashes + 1 : 0;
    text += character;
  }
  return text.append(backslashes, L'\\') + L'"';
}

}  // namespace

void take_utf8_arguments(int& argc, char**& argv) {
  static std::vector<std::string> words;
  static std::vector<char*> pointers;
  SetConsoleOutputCP(CP_UTF8);
  int count = 0;
  const std::unique_ptr<wchar_t*, decltype(&LocalFree)> wide(CommandLineToArgvW(GetCommandLineW(), &count),
                                                             &LocalFree);
  if (!wide) return;
  for (int i = 0; i < count; ++i) words.push_back(std::filesystem::path(wide.get()[i]).string());
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  argc = count;
  argv = pointers.data();
}

std::filesystem::path sibling(const std::string& program) {
  std::vector<wchar_t> name(32768);  // the longest path of Windows
  const DWORD length = GetModuleFileNameW(nullptr, name.data(), DWORD(name.size()));
  const std::filesystem::path self(name.begin(), name.begin() + length);
  const std::filesystem::path beside = self.parent_path() / (program + ".exe");
  std::error_code error;
  return std::filesystem::exists(beside, error) ? beside : std::filesystem::path(program);
}

int run_program(const std::vector<std::string>& arguments) {
  std::vector<std::wstring> words;
  for (const std::string& argument : arguments)
    words.push_back(quoted(std::filesystem::path(argument).wstring()));
  std::vector<const wchar_t*> argv;
  for (const std::wstring& word : words) argv.push_back(word.c_str());
  argv.push_back(nullptr);
  std::fflush(nullptr);
  const std::intptr_t status =
      _wspawnvp(_P_WAIT, std::filesystem::path(arguments.front()).c_str(), argv.data());
  return status < 0 ? 127 : static_cast<int>(status);
}

void become_program(const std::vector<std::string>& arguments) {
  const int status = run_program(arguments);
  if (status != 127) std::exit(status);
}

}  // namespace lobe::program
