// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Mends a surface that cannot be opened, tells what that changed, and writes it where a person says.

#include <QDialog>
#include <QString>
#include <filesystem>
#include <memory>

#include "desktop/framework/job.h"
#include "handpiece/base/geometry/repair.h"

class QCheckBox;
class QLabel;
class QProgressBar;
class QPushButton;

namespace handpiece::desktop {

/// Whether mending helps against this problem (Problem::id) of this file.
[[nodiscard]] bool canMend(const QString& problemId, const std::filesystem::path& file);

/// Whether a hole was closed that is more than a hole: as the border of an open arch.
[[nodiscard]] bool closesMuch(const geometry::RepairReport& report);

/// What was done to the surface, a sentence a line.
[[nodiscard]] QString mendWords(const geometry::RepairReport& report);

/// [mendDialog]. Begins at once; nothing is written before saveRequested() is answered with save().
class MendDialog : public QDialog {
    Q_OBJECT
  public:
    MendDialog(const std::filesystem::path& file, QWidget* parent);
    ~MendDialog() override;
    /// Throws core::Error. Once the surface is mended.
    void save(const std::filesystem::path& file) const;
    /// Those of a scan, which a .ply keeps and an .stl does not.
    [[nodiscard]] bool hasColours() const;

  signals:
    void saveRequested();

  private:
    struct Mended;
    void mend();  ///< anew where the base is ticked or unticked
    void tell(const geometry::RepairReport& report);

    std::filesystem::path file_;
    std::shared_ptr<Mended> mended_;
    QLabel* text_;
    QProgressBar* bar_;
    QCheckBox* base_;  ///< shown once a hole is closed that asks for it
    QPushButton* save_;
    std::unique_ptr<Job> job_;
};

}  // namespace handpiece::desktop
