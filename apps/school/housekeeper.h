// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a server does by itself from time to time: grades go to learning platforms, what need not be kept goes.

#include <condition_variable>
#include <mutex>
#include <thread>

#include "school/service.h"

namespace handpiece::school_server {

class Housekeeper {
  public:
    explicit Housekeeper(Service& service) : service_(service) {}
    ~Housekeeper() { stop(); }
    Housekeeper(const Housekeeper&) = delete;
    Housekeeper& operator=(const Housekeeper&) = delete;

    void start();
    void stop();
    /// One round, in the caller's thread. Throws core::Error.
    void round();

  private:
    Service& service_;
    school::Milliseconds expired_ = 0;  ///< when what need not be kept last went
    school::Milliseconds retried_ = 0;  ///< when what was given up was last begun anew
    std::mutex mutex_;
    std::condition_variable wake_;
    bool ends_ = false;
    std::thread thread_;
};

}  // namespace handpiece::school_server
