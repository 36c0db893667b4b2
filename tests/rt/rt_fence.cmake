# Reads the undefined symbols of the hot path's libraries: none may allocate, lock, throw, log, open or wait.
# Usage: cmake -DNM=nm -DLIBRARIES=a.a,b.a -DEXPECT=clean|caught -P rt_fence.cmake
# `caught` proves the fence: the library must break it.

# Names as `nm -u -C` prints them.  __stack_chk_fail and the program's own contract_broken end the process; both stay.
set(forbidden
  "operator new" "operator delete" "^malloc" "^calloc" "^realloc" "^free$" "^aligned_alloc" "^posix_memalign"
  "^pthread_" "^sem_" "^futex" "std::.*mutex" "std::condition_variable" "std::this_thread" "^nanosleep" "^usleep" "^poll$" "^select$"
  "^__cxa_throw" "^__cxa_allocate_exception" "^__cxa_guard" "std::__throw_" "^_Unwind_Resume"
  "^printf" "^fprintf" "^puts" "^fputs" "^fwrite" "^write$" "^read$" "^open" "^close$" "^syscall$" "^ioctl$" "^mmap" "^munmap"
  "std::ostream" "std::basic_ostream" "std::cout" "std::cerr" "^syslog" "std::__cxx11::basic_string" "std::function" "^dlopen")

string(REPLACE "," ";" libraries "${LIBRARIES}")
set(broken "")
foreach(library IN LISTS libraries)
  execute_process(COMMAND ${NM} -u -C ${library} OUTPUT_VARIABLE listing RESULT_VARIABLE status ERROR_QUIET)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${NM} cannot read ${library}")
  endif()
  string(REGEX MATCHALL " U [^\n]+" symbols "${listing}")
  if(NOT symbols)
    message(FATAL_ERROR "${library}: no undefined symbol at all; is it the right file?")
  endif()
  foreach(symbol IN LISTS symbols)
    string(REGEX REPLACE "^ U " "" symbol "${symbol}")
    foreach(pattern IN LISTS forbidden)
      if(symbol MATCHES "${pattern}")
        list(APPEND broken "${library}: ${symbol}")
      endif()
    endforeach()
  endforeach()
endforeach()

if(EXPECT STREQUAL "clean" AND broken)
  list(JOIN broken "\n  " text)
  message(FATAL_ERROR "the hot path reaches:\n  ${text}")
endif()
if(EXPECT STREQUAL "caught" AND NOT broken)
  message(FATAL_ERROR "the fence did not notice a library that allocates, locks, throws and prints")
endif()
