// SPDX-License-Identifier: MIT
// Finished passes over files of points, kept in a folder for a job that begins anew.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "batten/io/cloud_source.h"

namespace batten {

// What a job is: the name and value of all that its result follows from, besides the files.
using JobWords = std::map<std::string, std::string>;

// A file for each finished pass, `pass-K`, in a folder: written under another name, brought to the
// disk and renamed, so that it is whole or not there. It holds the words of the job, and of every
// file of the source size, time of change and a sum of its points. Where processes share the points
// each has a folder object with its rank over the same folder, and files `pass-K.rank-R`: they all
// keep what tells that their files are the same, and the first the numbers.
class CheckpointFolder : public PassStore {
 public:
  // Makes the folder where there is none. The source is referred to. Throws WriteError where it
  // can't be made or written to.
  CheckpointFolder(std::string folder, JobWords job, CloudFileSource& source, int rank = 0);

  // The source goes on after that pass. Throws ReadError where a pass was kept by another job, with
  // what differs, where a file has changed since, or where what is there is not whole.
  std::optional<std::vector<double>> Kept(int pass) override;

  void Keep(int pass, std::span<const double> numbers) override;

  // How many passes were found.
  int resumed() const { return resumed_; }

  // Removes what this object kept or found, and the folder where nothing else is in it: for a job
  // that is done.
  void Remove();

 private:
  std::string PathOf(int pass) const;

  std::string folder_;
  JobWords job_;
  CloudFileSource& source_;
  int rank_, passes_ = 0, resumed_ = 0;
};

}  // namespace batten
