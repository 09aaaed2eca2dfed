// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The teeth that the program makes: by the chart of the mouth, by resolution; cases by the chart.

#include "desktop/framework/feature.h"
#include "desktop/work/documents.h"

class QComboBox;

namespace handpiece::desktop {

class StarterFeature : public Feature {
    Q_OBJECT
  public:
    enum class Command { choose };
    explicit StarterFeature(const FeatureContext& context);
    /// Asks about unsaved work first.
    void open(const Starter& starter);

  private:
    [[nodiscard]] Starter now() const;
    [[nodiscard]] static QString resolutionText(const Resolution& resolution);
    void openAt(std::size_t faces);
    void fillMenu();
    void addResolutions();
    void choose();

    CommandSet<Command> commands_;
    QComboBox* resolution_;
};

}  // namespace handpiece::desktop
