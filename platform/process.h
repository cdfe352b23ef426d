// Starting other programs without a shell, and how this one was started. Standard types only.
#pragma once
#include <cstddef>

#include "platform/file.h"

namespace platform {

struct Process {
  long id = 0;     // 0: none
  int input = -1;  // the pipe to its input; -1: none
};

enum class ProcessState { running, succeeded, failed };

// Finds an executable of this name in PATH and writes its path to `path`. Returns false if there is none, or its path
// is too long.
bool find_program(const char* name, char* path, std::size_t path_bytes);

// Starts the program in the file `path`. `words` are its arguments, its name first and null last; `folder` is its
// working directory, null: this program's. Its input is empty and its output is dropped. It is killed when the thread
// that started it ends. The caller must see it end, by one of the next three functions. Returns false if the system has
// no room for it; a file that is not a program counts as a program that failed.
bool start_program(const char* path, const char* const* words, const char* folder, Process* process, FileError* error);

// Starts a program that reads its input from feed() and writes its errors to a file, which is replaced. Ctrl-C on the
// terminal does not reach it.
bool start_fed_program(const char* path, const char* const* words, const char* errors, Process* process,
                       FileError* error);
// Waits until it has taken the bytes. Returns false if it takes no more.
bool feed(Process* process, const void* bytes, std::size_t byte_count);
// Ends its input.
void end_feed(Process* process);

// Succeeded: it ended with status 0. After it has ended, the process is none, which counts as failed.
ProcessState look_at(Process* process);
// Waits until it ends. Returns true for status 0.
bool wait_for(Process* process);
// Kills it if it runs, and waits until it is gone.
void kill_process(Process* process);

// Gets the absolute path of this program's file. Returns false if unknown, or too long.
bool own_program(char* path, std::size_t path_bytes);
// Gets this program's arguments, its name first, each terminated by a 0. Returns their total size in bytes; 0: unknown,
// or they leave no byte free in the buffer.
std::size_t own_words(char* words, std::size_t words_bytes);

}  // namespace platform
