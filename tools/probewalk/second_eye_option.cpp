#include "tools/probewalk/second_eye_option.h"

#include "render/second_eye.h"

namespace probewalk {

void add_second_eye_option(CLI::App& command, std::string& name) {
  command
      .add_option("--second-eye", name,
                  "from-first: the second of two eyes goes by what the first has seen and traces only what that cannot "
                  "answer; traced: it traces all of its rays, as with --foveation")
      ->check(CLI::IsMember({kSecondEyeFromFirst, kSecondEyeTraced}))
      ->capture_default_str();
}

}  // namespace probewalk
