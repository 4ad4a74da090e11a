// SPDX-License-Identifier: MIT
// OpenCASCADE as a quiet, exclusive resource. Not installed; includes OpenCASCADE.
#pragma once

#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_SequenceOfPrinters.hxx>
#include <mutex>

namespace batten::internal {

// OpenCASCADE's translators keep their settings in globals and report to the standard streams.
// While a session lives no other thread has one, and nothing is printed; the embedding program's
// printers return with its end.
class OcctSession {
 public:
  OcctSession() : lock_(Mutex()), printers_(Message::DefaultMessenger()->Printers()) {
    Message::DefaultMessenger()->ChangePrinters().Clear();
  }
  ~OcctSession() { Message::DefaultMessenger()->ChangePrinters() = printers_; }
  OcctSession(const OcctSession&) = delete;
  OcctSession& operator=(const OcctSession&) = delete;

 private:
  static std::mutex& Mutex() {
    static std::mutex mutex;
    return mutex;
  }

  std::lock_guard<std::mutex> lock_;
  Message_SequenceOfPrinters printers_;
};

}  // namespace batten::internal
