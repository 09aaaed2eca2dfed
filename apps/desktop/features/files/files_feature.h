// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Opening, saving, exports, pictures, reports; what the window's title says, and the work that goes on beside it.

#include <functional>
#include <memory>

#include "desktop/framework/feature.h"

class QMenu;

namespace handpiece::desktop {

class FilesFeature : public Feature {
    Q_OBJECT
  public:
    enum class Command { openCase, openStl, resume, save, saveAs, stl, tissues, picture, report, quit };
    explicit FilesFeature(const FeatureContext& context);
    ~FilesFeature() override;
    void showDocument() override;

  private:
    void connectCommands();
    void connectJobs();
    void connectMessages();
    void enableCommands();
    void leave(std::function<void()> then);
    [[nodiscard]] Questions::Unsaved askUnsaved();
    void resumeLast();
    void save(bool underNewName, std::function<void()> then = {});
    void takeSaved(const QString& file);
    void writePicture();
    void listRecent();
    [[nodiscard]] QString recordingTitle() const;
    [[nodiscard]] QString exerciseTitle() const;
    void showTouch(const std::shared_ptr<const cases::Case>& surroundings);
    void showTitle();
    void hearOfFiles();
    void offerToMend(ErrorDialog* dialog);
    void mend();

    /// Where what was left out of a file goes while this window is there; told from any thread.
    struct Ear;

    CommandSet<Command> commands_;
    QMenu* recent_;
    std::shared_ptr<Ear> ear_;
    QString lastOpened_;     ///< or tried to
    double prepared_ = 0.0;  ///< of the tooth that comes
};

}  // namespace handpiece::desktop
