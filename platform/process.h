// Other programs, started without a shell, and what this one was started as. Standard types only.
#pragma once
#include <cstddef>

#include "platform/file.h"

namespace platform {

struct Process {
  long id = 0;  // 0: none
};

enum class ProcessState { running, succeeded, failed };

// The file that PATH has of this name, as text of `path`. False: there is none that may be run, or its path is too
// long.
bool find_program(const char* name, char* path, std::size_t path_bytes);

// Starts the program in the file `path`. `words` are its arguments, its name first and null last; `folder` is where it
// runs, null: where this program does. Its input is empty and what it prints is dropped. It is killed when the thread
// that started it ends. Whoever starts it has to see it end, by one of the next three. False: the system has no room
// for it; a file that is no program shows as one that failed.
bool start_program(const char* path, const char* const* words, const char* folder, Process* process, FileError* error);

// Succeeded: it ended with status 0. Once it has not been running, the process is none, which counts as failed.
ProcessState look_at(Process* process);
// Waits until it ends. True: with status 0.
bool wait_for(Process* process);
// Kills it, if it runs, and waits until it is gone.
void kill_process(Process* process);

// Path of the file that this program was started from, absolute. False: unknown, or too long.
bool own_program(char* path, std::size_t path_bytes);
// The words that this program was started with, its name first, each ended by a 0. Returns their bytes altogether; 0:
// unknown, or they leave no byte of the room.
std::size_t own_words(char* words, std::size_t words_bytes);

}  // namespace platform
