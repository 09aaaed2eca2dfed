// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/features.h"

#include <vector>

#include "desktop/features/device/device_feature.h"
#include "desktop/features/drill/drill_feature.h"
#include "desktop/features/editor/editor_feature.h"
#include "desktop/features/exercise/exercise_feature.h"
#include "desktop/features/exercise/practice_feature.h"
#include "desktop/features/files/files_feature.h"
#include "desktop/features/files/recovery_feature.h"
#include "desktop/features/files/starter_feature.h"
#include "desktop/features/landmarks/landmarks_feature.h"
#include "desktop/features/marking/marking_feature.h"
#include "desktop/features/measure/measure_feature.h"
#include "desktop/features/position/position_feature.h"
#include "desktop/features/radiograph/radiograph_feature.h"
#include "desktop/features/replay/replay_feature.h"
#include "desktop/features/scan/scan_feature.h"
#include "desktop/features/school/exam_feature.h"
#include "desktop/features/school/school_feature.h"
#include "desktop/features/sound/sound_feature.h"
#include "desktop/features/view/layout_feature.h"
#include "desktop/features/view/view_feature.h"
#include "desktop/work/simulator.h"

namespace handpiece::desktop {

void installFeatures(const FeatureContext& context) {
    MainWindow& window = context.window;
    Simulator& simulator = context.simulator;
    std::vector<Feature*> features;
    const auto add = [&features](Feature* feature) { features.push_back(feature); };
    // In the order in which they are asked about a file, and hear of a tooth: first the picture has it.
    add(new StarterFeature(context));
    add(new RecoveryFeature(context));
    add(new ViewFeature(context));
    add(new PositionFeature(context));
    auto* exercise = new ExerciseFeature(context);
    add(exercise);
    add(new PracticeFeature(context, *exercise));
    add(new SchoolFeature(context));  // after who keeps what was finished
    add(new LayoutFeature(context));
    add(new ReplayFeature(context));
    add(new MeasureFeature(context));
    add(new DrillFeature(context));
    add(new SoundFeature(context));
    add(new DeviceFeature(context));
    add(new MarkingFeature(context));  // before scans: both look at folders
    add(new EditorFeature(context));
    add(new ScanFeature(context));
    add(new RadiographFeature(context));
    add(new FilesFeature(context));      // it opens whatever the others leave
    add(new LandmarksFeature(context));  // once it is known what may be left
    add(new ExamFeature(context));       // nothing may, while an exam runs
    const auto refresh = [&window, &simulator] { window.refresh(simulator.permissions()); };
    const auto showTick = [features, refresh] {
        for (Feature* feature : features)
            feature->showTick();
        refresh();
    };
    const auto showDocument = [features, showTick] {
        for (Feature* feature : features)
            feature->showDocument();
        showTick();
    };
    QObject* first = features.front();  // with it the window ends
    QObject::connect(&simulator, &Simulator::documentChanged, first, showDocument);
    QObject::connect(&simulator, &Simulator::ticked, first, showTick);
    QObject::connect(&simulator, &Simulator::jobStarted, first, refresh);
    QObject::connect(&simulator, &Simulator::jobEnded, first, refresh);
    window.begin();
    showDocument();
}

}  // namespace handpiece::desktop
