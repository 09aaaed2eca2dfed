<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="ja_JP" sourcelanguage="en">
<context>
    <name>Commands</name>
    <message>
        <source>Let practice be watched</source>
        <translation>練習を公開する</translation>
    </message>
    <message>
        <source>Your teachers may look on while you practise, until you end it or the program</source>
        <translation>練習中の様子を教員が見られるようにします。オフにするかプログラムを終えるまで続きます</translation>
    </message>
    <message>
        <source>Work by mirror</source>
        <translation>ミラーテクニックで作業</translation>
    </message>
    <message>
        <source>See only the mirror&apos;s picture: left and right are changed over, the hand is not</source>
        <translation>ミラー像だけを見ます。左右は入れ替わりますが、手の動きはそのままです</translation>
    </message>
    <message>
        <source>Finger rest</source>
        <translation>フィンガーレスト</translation>
    </message>
    <message>
        <source>Support the hand on the nearest other tooth: it moves less and turns about there</source>
        <translation>最も近い別の歯に指を固定します。動きが小さくなり、そこを支点に回ります</translation>
    </message>
    <message>
        <source>Open case...</source>
        <translation>症例を開く...</translation>
    </message>
    <message>
        <source>Open a case, or an attempt that was saved</source>
        <translation>症例または保存した作業を開きます</translation>
    </message>
    <message>
        <source>Open STL...</source>
        <translation>STL を開く...</translation>
    </message>
    <message>
        <source>Open one closed surface as a tooth of enamel</source>
        <translation>閉じた曲面 1 つを、エナメル質だけの歯として開きます</translation>
    </message>
    <message>
        <source>Open recording...</source>
        <translation>記録を開く...</translation>
    </message>
    <message>
        <source>Open a recorded session to watch it</source>
        <translation>記録された実習を開いて再生します</translation>
    </message>
    <message>
        <source>Choose tooth...</source>
        <translation>歯を選ぶ...</translation>
    </message>
    <message>
        <source>Resume last attempt</source>
        <translation>前回の続き</translation>
    </message>
    <message>
        <source>Go on with the tooth that was saved last</source>
        <translation>最後に保存した歯の続きから始めます</translation>
    </message>
    <message>
        <source>Save</source>
        <translation>保存</translation>
    </message>
    <message>
        <source>Save what was cut</source>
        <translation>切削した歯を保存します</translation>
    </message>
    <message>
        <source>Save as...</source>
        <translation>名前を付けて保存...</translation>
    </message>
    <message>
        <source>Save what was cut under another name</source>
        <translation>切削した歯を別の名前で保存します</translation>
    </message>
    <message>
        <source>Export STL...</source>
        <translation>STL に書き出す...</translation>
    </message>
    <message>
        <source>Write what is left of the tooth as one closed STL surface</source>
        <translation>残っている歯を、閉じた 1 つの STL 曲面として書き出します</translation>
    </message>
    <message>
        <source>Picture...</source>
        <translation>画像を保存...</translation>
    </message>
    <message>
        <source>Keep what is seen as a PNG file</source>
        <translation>表示中の画面を PNG ファイルに保存します</translation>
    </message>
    <message>
        <source>Report...</source>
        <translation>レポート...</translation>
    </message>
    <message>
        <source>Write a page to print: before and after, volumes, times, forces</source>
        <translation>印刷用のページを作ります（切削前後、切削量、時間、力）</translation>
    </message>
    <message>
        <source>Quit</source>
        <translation>終了</translation>
    </message>
    <message>
        <source>Close the program</source>
        <translation>プログラムを終了します</translation>
    </message>
    <message>
        <source>Undo</source>
        <translation>元に戻す</translation>
    </message>
    <message>
        <source>Put back what the last stroke took away</source>
        <translation>直前のストロークで削った部分を元に戻します</translation>
    </message>
    <message>
        <source>Redo</source>
        <translation>やり直す</translation>
    </message>
    <message>
        <source>Take the stroke away again</source>
        <translation>元に戻したストロークをもう一度行います</translation>
    </message>
    <message>
        <source>Reset the tooth</source>
        <translation>歯を最初の状態に戻す</translation>
    </message>
    <message>
        <source>Put back all that was cut</source>
        <translation>削った部分をすべて元に戻します</translation>
    </message>
    <message>
        <source>Occlusal</source>
        <translation>咬合面</translation>
    </message>
    <message>
        <source>Occlusal view (key 1)</source>
        <translation>咬合面観（1 キー）</translation>
    </message>
    <message>
        <source>Buccal</source>
        <translation>頬側</translation>
    </message>
    <message>
        <source>Buccal view (key 2)</source>
        <translation>頬側面観（2 キー）</translation>
    </message>
    <message>
        <source>Lingual</source>
        <translation>舌側</translation>
    </message>
    <message>
        <source>Lingual view (key 3)</source>
        <translation>舌側面観（3 キー）</translation>
    </message>
    <message>
        <source>Mesial</source>
        <translation>近心</translation>
    </message>
    <message>
        <source>Mesial view (key 4)</source>
        <translation>近心面観（4 キー）</translation>
    </message>
    <message>
        <source>Distal</source>
        <translation>遠心</translation>
    </message>
    <message>
        <source>Distal view (key 5)</source>
        <translation>遠心面観（5 キー）</translation>
    </message>
    <message>
        <source>Oblique</source>
        <translation>斜め</translation>
    </message>
    <message>
        <source>Oblique view, occlusal and buccal (key 6)</source>
        <translation>斜め（咬合面・頬側）から見ます（6 キー）</translation>
    </message>
    <message>
        <source>Whole tooth</source>
        <translation>歯全体</translation>
    </message>
    <message>
        <source>Show the whole tooth (key Home)</source>
        <translation>歯全体を表示します（Home キー）</translation>
    </message>
    <message>
        <source>Go to the bur</source>
        <translation>バーへ移動</translation>
    </message>
    <message>
        <source>Look closely at the bur (key F)</source>
        <translation>バーの先を拡大します（F キー）</translation>
    </message>
    <message>
        <source>Practice</source>
        <translation>実習</translation>
    </message>
    <message>
        <source>A large picture and what one needs to cut</source>
        <translation>大きな画面と、切削に必要なものだけを表示します</translation>
    </message>
    <message>
        <source>Laboratory</source>
        <translation>実験</translation>
    </message>
    <message>
        <source>Every figure</source>
        <translation>すべての数値を表示します</translation>
    </message>
    <message>
        <source>As in the paper</source>
        <translation>論文の配置</translation>
    </message>
    <message>
        <source>The blocks of the paper&apos;s Figure 5</source>
        <translation>論文の図 5 と同じ構成で表示します</translation>
    </message>
    <message>
        <source>Panels to their places</source>
        <translation>パネルを元の位置に戻す</translation>
    </message>
    <message>
        <source>Undo all moving of panels in this layout</source>
        <translation>この配置で動かしたパネルをすべて元の位置に戻します</translation>
    </message>
    <message>
        <source>Full screen</source>
        <translation>全画面表示</translation>
    </message>
    <message>
        <source>Fill the whole screen</source>
        <translation>画面全体に表示します</translation>
    </message>
    <message>
        <source>As the desktop</source>
        <translation>デスクトップに合わせる</translation>
    </message>
    <message>
        <source>Light or dark as the desktop is</source>
        <translation>明るさをデスクトップの設定に合わせます</translation>
    </message>
    <message>
        <source>Light</source>
        <translation>ライト</translation>
    </message>
    <message>
        <source>Dark text on light ground</source>
        <translation>明るい背景に暗い文字で表示します</translation>
    </message>
    <message>
        <source>Dark</source>
        <translation>ダーク</translation>
    </message>
    <message>
        <source>Light text on dark ground</source>
        <translation>暗い背景に明るい文字で表示します</translation>
    </message>
    <message>
        <source>Touch</source>
        <translation>触る</translation>
    </message>
    <message>
        <source>The left button touches with the bur still</source>
        <translation>左ボタンで、回転していないバーを歯に当てます</translation>
    </message>
    <message>
        <source>Cut</source>
        <translation>切削</translation>
    </message>
    <message>
        <source>The left button presses and cuts</source>
        <translation>左ボタンで、バーを押し当てて削ります</translation>
    </message>
    <message>
        <source>Hold the pedal down</source>
        <translation>ペダルを踏み続ける</translation>
    </message>
    <message>
        <source>The turbine keeps turning (key P)</source>
        <translation>タービンを回し続けます（P キー）</translation>
    </message>
    <message>
        <source>Measure a distance</source>
        <translation>距離を測る</translation>
    </message>
    <message>
        <source>Calliper: click two points of the tooth</source>
        <translation>ノギス：歯の上の 2 点をクリックします</translation>
    </message>
    <message>
        <source>Measure a depth</source>
        <translation>深さを測る</translation>
    </message>
    <message>
        <source>Click a cut place: how far it lies below the uncut surface</source>
        <translation>削った場所をクリックすると、切削前の表面からの深さを示します</translation>
    </message>
    <message>
        <source>Measure to the pulp</source>
        <translation>歯髄までを測る</translation>
    </message>
    <message>
        <source>Click a cut place: remaining dentine thickness over the pulp</source>
        <translation>削った場所をクリックすると、歯髄までの残存象牙質の厚さを示します</translation>
    </message>
    <message>
        <source>Section</source>
        <translation>断面</translation>
    </message>
    <message>
        <source>Cut the picture open to look inside</source>
        <translation>歯を断面で表示して内部を見ます</translation>
    </message>
    <message>
        <source>Mouth mirror</source>
        <translation>デンタルミラー</translation>
    </message>
    <message>
        <source>Hold a mouth mirror</source>
        <translation>デンタルミラーを使います</translation>
    </message>
    <message>
        <source>Before and after</source>
        <translation>切削前後の比較</translation>
    </message>
    <message>
        <source>The uncut tooth beside the cut one</source>
        <translation>切削前の歯を並べて表示します</translation>
    </message>
    <message>
        <source>Clear measurements</source>
        <translation>計測を消す</translation>
    </message>
    <message>
        <source>Take all measurements away</source>
        <translation>計測の表示をすべて消します</translation>
    </message>
    <message>
        <source>Keep recording...</source>
        <translation>記録を保存...</translation>
    </message>
    <message>
        <source>Every session is recorded; keep a copy of this one</source>
        <translation>実習は毎回記録されます。今回の記録の写しを保存します</translation>
    </message>
    <message>
        <source>Replay</source>
        <translation>再生</translation>
    </message>
    <message>
        <source>Watch what you have done so far; closing the replay brings the tooth back</source>
        <translation>ここまでの操作を再生します。再生を閉じると歯に戻ります</translation>
    </message>
    <message>
        <source>Keys and mouse...</source>
        <translation>キーとマウスの設定...</translation>
    </message>
    <message>
        <source>Choose which key or button does what</source>
        <translation>キーやボタンの働きを選びます</translation>
    </message>
    <message>
        <source>Mute</source>
        <translation>消音</translation>
    </message>
    <message>
        <source>No sound</source>
        <translation>音を出しません</translation>
    </message>
    <message>
        <source>Motor louder</source>
        <translation>モーター音を大きく</translation>
    </message>
    <message>
        <source>Motor sound louder</source>
        <translation>モーター音を大きくします</translation>
    </message>
    <message>
        <source>Motor softer</source>
        <translation>モーター音を小さく</translation>
    </message>
    <message>
        <source>Motor sound softer</source>
        <translation>モーター音を小さくします</translation>
    </message>
    <message>
        <source>Cutting louder</source>
        <translation>切削音を大きく</translation>
    </message>
    <message>
        <source>Cutting sound louder</source>
        <translation>切削音を大きくします</translation>
    </message>
    <message>
        <source>Cutting softer</source>
        <translation>切削音を小さく</translation>
    </message>
    <message>
        <source>Cutting sound softer</source>
        <translation>切削音を小さくします</translation>
    </message>
    <message>
        <source>Keys and mouse at a glance</source>
        <translation>キーとマウスの一覧</translation>
    </message>
    <message>
        <source>Show which key does what</source>
        <translation>どのキーで何ができるかを表示します</translation>
    </message>
    <message>
        <source>First steps again</source>
        <translation>最初のヒントをもう一度</translation>
    </message>
    <message>
        <source>Show the hints of the first minute again, from the first</source>
        <translation>最初の操作のヒントを、もう一度はじめから表示します</translation>
    </message>
    <message>
        <source>User guide</source>
        <translation>使い方の手引き</translation>
    </message>
    <message>
        <source>Read how everything is done, chapter by chapter</source>
        <translation>使い方を章ごとに読めます</translation>
    </message>
    <message>
        <source>About Handpiece</source>
        <translation>Handpiece について</translation>
    </message>
    <message>
        <source>Version, licences</source>
        <translation>バージョンとライセンスを表示します</translation>
    </message>
    <message>
        <source>Open</source>
        <translation>開く</translation>
    </message>
    <message>
        <source>Teeth</source>
        <translation>歯列</translation>
    </message>
    <message>
        <source>Resume</source>
        <translation>続き</translation>
    </message>
    <message>
        <source>Reset</source>
        <translation>初期化</translation>
    </message>
    <message>
        <source>Mirror</source>
        <translation>ミラー</translation>
    </message>
    <message>
        <source>Distance</source>
        <translation>距離</translation>
    </message>
    <message>
        <source>Depth</source>
        <translation>深さ</translation>
    </message>
    <message>
        <source>To pulp</source>
        <translation>歯髄まで</translation>
    </message>
    <message>
        <source>Compare</source>
        <translation>比較</translation>
    </message>
    <message>
        <source>Record</source>
        <translation>記録</translation>
    </message>
    <message>
        <source>Recover...</source>
        <translation>復元...</translation>
    </message>
    <message>
        <source>Bring back, or give up, work that ended without saving</source>
        <translation>保存されずに終わった作業を復元、または破棄します</translation>
    </message>
    <message>
        <source>Your code...</source>
        <translation>受講者コード...</translation>
    </message>
    <message>
        <source>The code your teacher gave you: it goes into recordings and saved attempts</source>
        <translation>先生から渡されたコードです。記録と、保存した作業に書き込まれます</translation>
    </message>
    <message>
        <source>New case from scan...</source>
        <translation>スキャンから新しい症例...</translation>
    </message>
    <message>
        <source>Make a tooth to be cut out of a CT: slices, a DICOM folder, a volume</source>
        <translation>CT（スライス画像のフォルダー、ボリューム）から、切削できる歯を作ります</translation>
    </message>
    <message>
        <source>Device page...</source>
        <translation>デバイスのページ...</translation>
    </message>
    <message>
        <source>How the device is doing, its settings, and a check of how good it feels</source>
        <translation>デバイスの状態、設定、手ごたえの検査を表示します</translation>
    </message>
    <message>
        <source>Set up...</source>
        <translation>準備...</translation>
    </message>
    <message>
        <source>Connect, calibrate, feel a block</source>
        <translation>接続、校正、ブロックに触れる練習をします</translation>
    </message>
    <message>
        <source>Look for devices</source>
        <translation>デバイスを探す</translation>
    </message>
    <message>
        <source>Look again which devices are connected</source>
        <translation>接続されているデバイスをもう一度探します</translation>
    </message>
    <message>
        <source>Export tissues...</source>
        <translation>組織ごとに書き出す...</translation>
    </message>
    <message>
        <source>Write what is left of each tissue as a closed STL surface of its own</source>
        <translation>残っている組織を、それぞれ 1 つの閉じた STL 曲面として書き出します</translation>
    </message>
    <message>
        <source>Hand in...</source>
        <translation>提出...</translation>
    </message>
    <message>
        <source>Give the attempt to your teacher: one file with the tooth and what was recorded</source>
        <translation>課題の結果を先生に渡す: 歯と記録をひとつのファイルにまとめます</translation>
    </message>
    <message>
        <source>Exercise</source>
        <translation>課題</translation>
    </message>
    <message>
        <source>Show the exercise: its title and what to do</source>
        <translation>課題の題名と指示を表示します</translation>
    </message>
    <message>
        <source>Device by name or serial...</source>
        <translation>名前またはシリアル番号で装置を選ぶ...</translation>
    </message>
    <message>
        <source>Choose one of several equal devices</source>
        <translation>同じ種類の装置が複数あるとき、そのひとつを選びます</translation>
    </message>
    <message>
        <source>Locked by this exercise.</source>
        <translation>この課題ではロックされています。</translation>
    </message>
    <message>
        <source>Radiograph...</source>
        <translation>X 線画像...</translation>
    </message>
    <message>
        <source>A simulated bitewing or periapical radiograph of the tooth that is open</source>
        <translation>開いている歯の咬翼法・根尖投影（デンタル）の模擬 X 線画像</translation>
    </message>
    <message>
        <source>Choose a tooth, and whose, on the chart of the mouth</source>
        <translation>歯列の図で、だれのどの歯かを選びます</translation>
    </message>
    <message>
        <source>Landmarks</source>
        <translation>解剖学的指標点</translation>
    </message>
    <message>
        <source>Cusp tips, fissures, ridges, contacts and the like over the tooth, and their list</source>
        <translation>咬頭頂、裂溝、隆線、接触点などを歯の上に示し、一覧を開きます</translation>
    </message>
    <message>
        <source>Move landmarks</source>
        <translation>指標点を動かす</translation>
    </message>
    <message>
        <source>For teachers: drag a landmark over the tooth</source>
        <translation>指導者用：指標点を歯の上でドラッグします</translation>
    </message>
    <message>
        <source>Marking desk...</source>
        <translation>採点机...</translation>
    </message>
    <message>
        <source>For teachers: score, look at and mark a folder of returned work</source>
        <translation>教員用：提出物のフォルダーを採点し、見て、評価します</translation>
    </message>
    <message>
        <source>Exercises...</source>
        <translation>課題を選ぶ...</translation>
    </message>
    <message>
        <source>Choose an exercise: what it asks, the ideal, your best so far</source>
        <translation>課題を選びます（内容、理想形、これまでの最高点）</translation>
    </message>
    <message>
        <source>Exercises</source>
        <translation>課題</translation>
    </message>
    <message>
        <source>Finish</source>
        <translation>完了</translation>
    </message>
    <message>
        <source>Your work on this exercise is done: it is judged, and you see why</source>
        <translation>この課題の作業を終えて採点し、その理由を表示します</translation>
    </message>
    <message>
        <source>Result</source>
        <translation>結果</translation>
    </message>
    <message>
        <source>The result of the work that was finished last</source>
        <translation>最後に終えた作業の結果を表示します</translation>
    </message>
    <message>
        <source>Progress...</source>
        <translation>上達の記録...</translation>
    </message>
    <message>
        <source>Your results over the attempts at each exercise</source>
        <translation>課題ごとに、回を追った結果を表示します</translation>
    </message>
    <message>
        <source>Task in the picture</source>
        <translation>課題を画像に表示</translation>
    </message>
    <message>
        <source>What is to go and what must stay, as glass over the tooth</source>
        <translation>削る部分と残すべき部分を、歯の上に透明なガラスとして表示します</translation>
    </message>
    <message>
        <source>Begin an exam...</source>
        <translation>試験を始める...</translation>
    </message>
    <message>
        <source>An exam of your school, with an invigilator beside you, by the code on your slip</source>
        <translation>学校の試験を、監督者の立会いのもと、受験票のコードで始めます</translation>
    </message>
    <message>
        <source>Not in this exam.</source>
        <translation>この試験では使えません。</translation>
    </message>
    <message>
        <source>New exercise...</source>
        <translation>新しい課題...</translation>
    </message>
    <message>
        <source>For teachers: set a task, from its tooth to how it is judged</source>
        <translation>教員用：歯の選択から評価の方法まで、課題を作ります</translation>
    </message>
    <message>
        <source>Edit exercise...</source>
        <translation>課題を編集...</translation>
    </message>
    <message>
        <source>For teachers: change an exercise that was saved</source>
        <translation>教員用：保存した課題を変更します</translation>
    </message>
</context>
<context>
    <name>BurPicture</name>
    <message>
        <source>black</source>
        <translation>黒</translation>
    </message>
    <message>
        <source>green</source>
        <translation>緑</translation>
    </message>
    <message>
        <source>blue</source>
        <translation>青</translation>
    </message>
    <message>
        <source>red</source>
        <translation>赤</translation>
    </message>
    <message>
        <source>yellow</source>
        <translation>黄</translation>
    </message>
    <message>
        <source>white</source>
        <translation>白</translation>
    </message>
    <message>
        <source>Round</source>
        <translation>ラウンド</translation>
    </message>
    <message>
        <source>Inverted cone</source>
        <translation>インバーテッドコーン</translation>
    </message>
    <message>
        <source>Cylinder, flat end</source>
        <translation>シリンダー（平頭）</translation>
    </message>
    <message>
        <source>Cylinder, round end</source>
        <translation>シリンダー（丸頭）</translation>
    </message>
    <message>
        <source>Taper, flat end</source>
        <translation>テーパー（平頭）</translation>
    </message>
    <message>
        <source>Taper, round end</source>
        <translation>テーパー（丸頭）</translation>
    </message>
    <message>
        <source>Pear</source>
        <translation>ペアシェイプ</translation>
    </message>
    <message>
        <source>Flame</source>
        <translation>フレーム（火炎形）</translation>
    </message>
    <message>
        <source>Torpedo</source>
        <translation>トーピード</translation>
    </message>
    <message>
        <source>Wheel</source>
        <translation>ホイール</translation>
    </message>
    <message>
        <source>Diamond, extra fine</source>
        <translation>ダイヤモンド（超微粒子）</translation>
    </message>
    <message>
        <source>Diamond, fine</source>
        <translation>ダイヤモンド（微粒子）</translation>
    </message>
    <message>
        <source>Diamond, medium</source>
        <translation>ダイヤモンド（普通粒子）</translation>
    </message>
    <message>
        <source>Diamond, coarse</source>
        <translation>ダイヤモンド（粗粒子）</translation>
    </message>
    <message>
        <source>Carbide</source>
        <translation>カーバイド</translation>
    </message>
    <message>
        <source>Carbide, cross-cut</source>
        <translation>カーバイド（クロスカット）</translation>
    </message>
    <message>
        <source>Carbide, finishing</source>
        <translation>カーバイド（仕上げ用）</translation>
    </message>
    <message>
        <source>Steel</source>
        <translation>スチール</translation>
    </message>
</context>
<context>
    <name>Exercise</name>
    <message>
        <source>Undo, redo, reset</source>
        <translation>元に戻す、やり直す、初期化</translation>
    </message>
    <message>
        <source>Reset</source>
        <translation>初期化</translation>
    </message>
    <message>
        <source>Depths, calliper, depth stop</source>
        <translation>深さ、ノギス、深さ制限</translation>
    </message>
    <message>
        <source>Colours of the tissues, legend</source>
        <translation>組織の色、凡例</translation>
    </message>
    <message>
        <source>Section</source>
        <translation>断面</translation>
    </message>
    <message>
        <source>Hidden tissues, the tooth before, before and after</source>
        <translation>組織の非表示、切削前の歯、前後の比較</translation>
    </message>
    <message>
        <source>First steps, hints, landmarks, depth stop</source>
        <translation>最初の手順、ヒント、指標点、深さ制限</translation>
    </message>
    <message>
        <source>Removed volumes, report</source>
        <translation>切削量、レポート</translation>
    </message>
    <message>
        <source>Mouth mirror</source>
        <translation>デンタルミラー</translation>
    </message>
    <message>
        <source>Scale bar</source>
        <translation>スケールバー</translation>
    </message>
    <message>
        <source>Chart of the mouth</source>
        <translation>歯列図</translation>
    </message>
    <message>
        <source>Calliper</source>
        <translation>ノギス</translation>
    </message>
    <message>
        <source>Before and after</source>
        <translation>前後の比較</translation>
    </message>
    <message>
        <source>Direct view: work by mirror</source>
        <translation>直視（ミラー視で作業します）</translation>
    </message>
    <message>
        <source>undo</source>
        <translation>元に戻す</translation>
    </message>
    <message>
        <source>redo</source>
        <translation>やり直す</translation>
    </message>
    <message>
        <source>reset</source>
        <translation>初期化</translation>
    </message>
    <message>
        <source>depth stop</source>
        <translation>深さ制限</translation>
    </message>
    <message>
        <source>depths</source>
        <translation>深さ</translation>
    </message>
    <message>
        <source>measuring a depth</source>
        <translation>深さの測定</translation>
    </message>
    <message>
        <source>measuring to the pulp</source>
        <translation>歯髄までの測定</translation>
    </message>
    <message>
        <source>calliper</source>
        <translation>ノギス</translation>
    </message>
    <message>
        <source>removed depth</source>
        <translation>除去した深さ</translation>
    </message>
    <message>
        <source>colours of the tissues</source>
        <translation>組織の色</translation>
    </message>
    <message>
        <source>section</source>
        <translation>断面</translation>
    </message>
    <message>
        <source>hidden tissues</source>
        <translation>組織の非表示</translation>
    </message>
    <message>
        <source>before and after</source>
        <translation>前後の比較</translation>
    </message>
    <message>
        <source>mouth mirror</source>
        <translation>デンタルミラー</translation>
    </message>
    <message>
        <source>direct view</source>
        <translation>直視</translation>
    </message>
    <message>
        <source>change between direct view and mirror</source>
        <translation>直視とミラー視の切り替え</translation>
    </message>
    <message>
        <source>scale bar</source>
        <translation>スケールバー</translation>
    </message>
    <message>
        <source>chart of the mouth</source>
        <translation>歯列図</translation>
    </message>
    <message>
        <source>hints</source>
        <translation>ヒント</translation>
    </message>
    <message>
        <source>removed volumes</source>
        <translation>切削量</translation>
    </message>
    <message>
        <source>report</source>
        <translation>レポート</translation>
    </message>
    <message>
        <source>other work</source>
        <translation>ほかの作業</translation>
    </message>
</context>
<context>
    <name>HelpCard</name>
    <message>
        <source>or</source>
        <translation>または</translation>
    </message>
</context>
<context>
    <name>KeyBindings</name>
    <message>
        <source>Ctrl</source>
        <translation>Ctrl</translation>
    </message>
    <message>
        <source>Shift</source>
        <translation>Shift</translation>
    </message>
    <message>
        <source>left button</source>
        <translation>左ボタン</translation>
    </message>
    <message>
        <source>right button</source>
        <translation>右ボタン</translation>
    </message>
    <message>
        <source>middle button</source>
        <translation>中ボタン</translation>
    </message>
    <message>
        <source>back button</source>
        <translation>戻るボタン</translation>
    </message>
    <message>
        <source>forward button</source>
        <translation>進むボタン</translation>
    </message>
    <message>
        <source>Cut: pedal down, press and drag</source>
        <translation>切削：ペダルを踏み、押し当てて動かす</translation>
    </message>
    <message>
        <source>Touch with the bur still</source>
        <translation>バーを回さずに触る</translation>
    </message>
    <message>
        <source>Turn the view</source>
        <translation>視点を回す</translation>
    </message>
    <message>
        <source>Shift the view</source>
        <translation>視点をずらす</translation>
    </message>
    <message>
        <source>Nearer, farther</source>
        <translation>近づく・遠ざかる</translation>
    </message>
    <message>
        <source>Load on the bur</source>
        <translation>バーにかける荷重</translation>
    </message>
    <message>
        <source>Depth stop</source>
        <translation>深さ制限</translation>
    </message>
    <message>
        <source>Five times slower, finer steps</source>
        <translation>5 分の 1 の速さ、細かい動き</translation>
    </message>
    <message>
        <source>Roll to the left</source>
        <translation>左に回す</translation>
    </message>
    <message>
        <source>Roll to the right</source>
        <translation>右に回す</translation>
    </message>
    <message>
        <source>Bur square to the surface</source>
        <translation>バーを表面に垂直に</translation>
    </message>
    <message>
        <source>Bur along the tooth&apos;s long axis</source>
        <translation>バーを歯軸に平行に</translation>
    </message>
    <message>
        <source>Bur to the left</source>
        <translation>バーを左へ</translation>
    </message>
    <message>
        <source>Bur to the right</source>
        <translation>バーを右へ</translation>
    </message>
    <message>
        <source>Bur up</source>
        <translation>バーを上へ</translation>
    </message>
    <message>
        <source>Bur down</source>
        <translation>バーを下へ</translation>
    </message>
    <message>
        <source>Bur in along its axis</source>
        <translation>バーを軸方向に進める</translation>
    </message>
    <message>
        <source>Bur out along its axis</source>
        <translation>バーを軸方向に引く</translation>
    </message>
    <message>
        <source>Pedal stays down</source>
        <translation>ペダルを踏み続ける</translation>
    </message>
    <message>
        <source>More speed</source>
        <translation>回転を速く</translation>
    </message>
    <message>
        <source>Less speed</source>
        <translation>回転を遅く</translation>
    </message>
    <message>
        <source>Next bur</source>
        <translation>次のバー</translation>
    </message>
    <message>
        <source>Oblique</source>
        <translation>斜め</translation>
    </message>
    <message>
        <source>Whole tooth</source>
        <translation>歯全体</translation>
    </message>
    <message>
        <source>Section</source>
        <translation>断面</translation>
    </message>
    <message>
        <source>Mouth mirror</source>
        <translation>デンタルミラー</translation>
    </message>
    <message>
        <source>Before and after</source>
        <translation>切削前後の比較</translation>
    </message>
    <message>
        <source>Stop: pedal up, bur lifts</source>
        <translation>停止：ペダルを離し、バーを上げる</translation>
    </message>
    <message>
        <source>This card</source>
        <translation>この一覧</translation>
    </message>
    <message>
        <source>Cutting</source>
        <translation>切削</translation>
    </message>
    <message>
        <source>The hand</source>
        <translation>手の動き</translation>
    </message>
    <message>
        <source>The view</source>
        <translation>視点</translation>
    </message>
    <message>
        <source>Tools</source>
        <translation>道具</translation>
    </message>
    <message>
        <source>wheel</source>
        <translation>ホイール</translation>
    </message>
    <message>
        <source>Distance, depth, pulp in turn</source>
        <translation>距離・深さ・歯髄を順に</translation>
    </message>
    <message>
        <source>Hold, move or arrows: turn the view</source>
        <translation>押しながら動かす・矢印：視点を回す</translation>
    </message>
    <message>
        <source>Hold, move or arrows: shift the view</source>
        <translation>押しながら動かす・矢印：視点をずらす</translation>
    </message>
    <message>
        <source>Hold, move or arrows: tilt about the tip</source>
        <translation>押しながら動かす・矢印：先端を軸に傾ける</translation>
    </message>
    <message>
        <source>Nearer</source>
        <translation>近づく</translation>
    </message>
    <message>
        <source>Farther</source>
        <translation>遠ざかる</translation>
    </message>
    <message>
        <source>Hold: cut where the bur is; or pick</source>
        <translation>押している間：その場で切削・点を選ぶ</translation>
    </message>
    <message>
        <source>Hold: touch where the bur is</source>
        <translation>押している間：その場で触れる</translation>
    </message>
    <message>
        <source>More load</source>
        <translation>荷重を増やす</translation>
    </message>
    <message>
        <source>Less load</source>
        <translation>荷重を減らす</translation>
    </message>
    <message>
        <source>Depth stop on, deeper</source>
        <translation>深さ制限を入れる、深く</translation>
    </message>
    <message>
        <source>Depth stop shallower, off</source>
        <translation>深さ制限を浅く、切る</translation>
    </message>
    <message>
        <source>Occlusal</source>
        <translation>咬合面</translation>
    </message>
    <message>
        <source>Buccal</source>
        <translation>頬側</translation>
    </message>
    <message>
        <source>Lingual</source>
        <translation>舌側</translation>
    </message>
    <message>
        <source>Mesial</source>
        <translation>近心</translation>
    </message>
    <message>
        <source>Distal</source>
        <translation>遠心</translation>
    </message>
    <message>
        <source>Go to the bur</source>
        <translation>バーへ移動</translation>
    </message>
    <message>
        <source>Depth of one pass</source>
        <translation>1回の切削の深さ</translation>
    </message>
    <message>
        <source>Previous bur</source>
        <translation>前のバー</translation>
    </message>
    <message>
        <source>One pass on, shallower</source>
        <translation>1回の深さを入れる、浅く</translation>
    </message>
    <message>
        <source>One pass deeper, off</source>
        <translation>1回の深さを深く、切る</translation>
    </message>
</context>
<context>
    <name>Measuring</name>
    <message>
        <source>%1 mm</source>
        <translation>%1 mm</translation>
    </message>
    <message>
        <source>%1 deep, %2 along the bur</source>
        <translation>深さ %1、バー軸方向 %2</translation>
    </message>
    <message>
        <source>%1 deep</source>
        <translation>深さ %1</translation>
    </message>
    <message>
        <source>%1 of dentine to the pulp</source>
        <translation>歯髄まで象牙質 %1</translation>
    </message>
    <message>
        <source>Bucco-lingual</source>
        <translation>頬舌断</translation>
    </message>
    <message>
        <source>Mesio-distal</source>
        <translation>近遠心断</translation>
    </message>
    <message>
        <source>Horizontal</source>
        <translation>水平断</translation>
    </message>
    <message>
        <source>none</source>
        <translation>なし</translation>
    </message>
    <message>
        <source>Enamel</source>
        <translation>エナメル質</translation>
    </message>
    <message>
        <source>Dentine</source>
        <translation>象牙質</translation>
    </message>
    <message>
        <source>Pulp</source>
        <translation>歯髄</translation>
    </message>
    <message>
        <source>Caries</source>
        <translation>う蝕</translation>
    </message>
    <message>
        <source>Cementum</source>
        <translation>セメント質</translation>
    </message>
    <message>
        <source>Gingiva</source>
        <translation>歯肉</translation>
    </message>
    <message>
        <source>Bone</source>
        <translation>骨</translation>
    </message>
    <message>
        <source>Adjacent tooth</source>
        <translation>隣在歯</translation>
    </message>
    <message>
        <source>Restoration</source>
        <translation>修復物</translation>
    </message>
    <message>
        <source>Demineralised enamel</source>
        <translation>脱灰エナメル質</translation>
    </message>
    <message>
        <source>Soft carious dentine</source>
        <translation>軟化う蝕象牙質</translation>
    </message>
    <message>
        <source>Soft to leathery carious dentine</source>
        <translation>軟らかい～革状のう蝕象牙質</translation>
    </message>
    <message>
        <source>Leathery carious dentine</source>
        <translation>革状のう蝕象牙質</translation>
    </message>
    <message>
        <source>Leathery to firm carious dentine</source>
        <translation>革状～やや硬いう蝕象牙質</translation>
    </message>
    <message>
        <source>Firm carious dentine</source>
        <translation>やや硬いう蝕象牙質</translation>
    </message>
    <message>
        <source>Firm to hard carious dentine</source>
        <translation>やや硬い～硬いう蝕象牙質</translation>
    </message>
    <message>
        <source>Stained enamel</source>
        <translation>着色エナメル質</translation>
    </message>
    <message>
        <source>Calculus</source>
        <translation>歯石</translation>
    </message>
</context>
<context>
    <name>MendDialog</name>
    <message>
        <source>Holes closed: %1, with %2 mm² of new surface.</source>
        <translation>閉じた穴：%1、新しい面 %2 mm²。</translation>
    </message>
    <message>
        <source>Faces turned to face outwards: %1.</source>
        <translation>外向きに直した面：%1。</translation>
    </message>
    <message>
        <source>Edges of more than two faces cut apart: %1.</source>
        <translation>切り離した、3 面以上が接する辺：%1。</translation>
    </message>
    <message>
        <source>Loose pieces left out: %1, with %2 faces.</source>
        <translation>除いた離れた部分：%1、面 %2。</translation>
    </message>
    <message>
        <source>Faces left out that were flat, double or hung loose: %1.</source>
        <translation>除いた面（つぶれた・重複・浮いた）：%1。</translation>
    </message>
    <message>
        <source>Faces replaced where the surface crossed itself: %1.</source>
        <translation>交差していて置き換えた面：%1。</translation>
    </message>
    <message>
        <source>Stood on a flat base of %1 mm².</source>
        <translation>平らな基底部を付けました：%1 mm²。</translation>
    </message>
    <message>
        <source>Much of this surface is new. The border of an open arch is better stood on a flat base.</source>
        <translation>新しい面が大きな割合を占めています。開いた歯列弓の縁には、平らな基底部を付けるほうが適しています。</translation>
    </message>
    <message>
        <source>Nothing had to be changed but where vertices meet.</source>
        <translation>頂点の結合のほかに変更はありません。</translation>
    </message>
    <message>
        <source>Surface before %1 mm², after %2 mm².</source>
        <translation>表面積：前 %1 mm²、後 %2 mm²。</translation>
    </message>
</context>
<context>
    <name>Notation</name>
    <message>
        <source>central incisor</source>
        <translation>中切歯</translation>
    </message>
    <message>
        <source>lateral incisor</source>
        <translation>側切歯</translation>
    </message>
    <message>
        <source>canine</source>
        <translation>犬歯</translation>
    </message>
    <message>
        <source>first premolar</source>
        <translation>第一小臼歯</translation>
    </message>
    <message>
        <source>second premolar</source>
        <translation>第二小臼歯</translation>
    </message>
    <message>
        <source>first molar</source>
        <translation>第一大臼歯</translation>
    </message>
    <message>
        <source>second molar</source>
        <translation>第二大臼歯</translation>
    </message>
    <message>
        <source>third molar</source>
        <translation>第三大臼歯</translation>
    </message>
    <message>
        <source>primary central incisor</source>
        <translation>乳中切歯</translation>
    </message>
    <message>
        <source>primary lateral incisor</source>
        <translation>乳側切歯</translation>
    </message>
    <message>
        <source>primary canine</source>
        <translation>乳犬歯</translation>
    </message>
    <message>
        <source>primary first molar</source>
        <translation>第一乳臼歯</translation>
    </message>
    <message>
        <source>primary second molar</source>
        <translation>第二乳臼歯</translation>
    </message>
    <message>
        <source>Upper right %1</source>
        <translation>上顎右側%1</translation>
    </message>
    <message>
        <source>Upper left %1</source>
        <translation>上顎左側%1</translation>
    </message>
    <message>
        <source>Lower left %1</source>
        <translation>下顎左側%1</translation>
    </message>
    <message>
        <source>Lower right %1</source>
        <translation>下顎右側%1</translation>
    </message>
</context>
<context>
    <name>Notices</name>
    <message>
        <source>This session is not being recorded: %1</source>
        <translation>この実習は記録されていません：%1</translation>
    </message>
    <message>
        <source>The device gives all the force it has.</source>
        <translation>デバイスの出せる最大の力に達しています。</translation>
    </message>
    <message>
        <source>The bur has stalled: press less.</source>
        <translation>バーが止まりました。押す力を弱めてください。</translation>
    </message>
    <message>
        <source>The device reports a fault.</source>
        <translation>デバイスに異常があります。</translation>
    </message>
    <message>
        <source>There is no memory left to cut more of this tooth.</source>
        <translation>メモリーが足りないため、この歯はこれ以上削れません。</translation>
    </message>
    <message>
        <source>The recording has a gap: ticks that are missing: %1</source>
        <translation>記録に抜けがあります。抜けた周期の数：%1</translation>
    </message>
    <message>
        <source>The computer is too busy. Samples lost: %1</source>
        <translation>コンピューターの負荷が高すぎます。失われたデータの数：%1</translation>
    </message>
    <message>
        <source>There is nothing to undo.</source>
        <translation>元に戻す操作がありません。</translation>
    </message>
    <message>
        <source>There is nothing to redo.</source>
        <translation>やり直す操作がありません。</translation>
    </message>
    <message>
        <source>Nothing was cut yet.</source>
        <translation>まだ何も削っていません。</translation>
    </message>
    <message>
        <source>Not while you cut: lift the bur first.</source>
        <translation>切削中はできません。先にバーを上げてください。</translation>
    </message>
    <message>
        <source>With the convex hull the bur touches and does not cut.</source>
        <translation>凸包では、バーは歯に触れるだけで、切削はできません。</translation>
    </message>
    <message>
        <source>This could not be done: %1</source>
        <translation>実行できませんでした：%1</translation>
    </message>
    <message>
        <source>The adjacent tooth was touched.</source>
        <translation>隣在歯に触れました。</translation>
    </message>
    <message>
        <source>The adjacent tooth was cut.</source>
        <translation>隣在歯が切削されました。</translation>
    </message>
    <message>
        <source>The bur is in the gingiva.</source>
        <translation>バーが歯肉に入っています。</translation>
    </message>
    <message>
        <source>The handpiece rests on a tooth: the bur is held off.</source>
        <translation>ハンドピースが歯に当たっており、バーが届きません。</translation>
    </message>
    <message>
        <source>The bur has reached dentine.</source>
        <translation>バーが象牙質に達しました。</translation>
    </message>
    <message>
        <source>The convex hull knows the whole tooth only, and this one is cut. Reset the tooth first.</source>
        <translation>凸包は切削前の歯にしか使えませんが、この歯は削られています。先に歯を最初の状態に戻してください。</translation>
    </message>
    <message>
        <source>The settings could not be read and start anew. The old file is kept at %1</source>
        <translation>設定を読み込めなかったため、初期設定で始めます。元のファイルは %1 に残してあります</translation>
    </message>
    <message>
        <source>The bur it was cut with, %1, is not at hand: %2 is in its place.</source>
        <translation>切削に使ったバー %1 がないため、代わりに %2 を使います。</translation>
    </message>
    <message>
        <source>Recorded by engine revision %1; this program&apos;s is %2. What you see is cut again approximately.</source>
        <translation>エンジン改訂 %1 による記録です。このプログラムの改訂は %2 なので、表示されているのは近似的な再切削です。</translation>
    </message>
    <message>
        <source>This exercise does not allow the bur %1.</source>
        <translation>この課題ではバー %1 を使えません。</translation>
    </message>
    <message>
        <source>The tooth you opened is no longer at %1. It was saved together with the attempt.</source>
        <translation>開いた歯が %1 に見つかりません。歯は作業と一緒に保存してあります。</translation>
    </message>
    <message>
        <source>Saved: %1</source>
        <translation>保存しました：%1</translation>
    </message>
    <message>
        <source>There is no translation into this language: the window speaks English.</source>
        <translation>この言語の翻訳がないため、英語で表示します。</translation>
    </message>
    <message>
        <source>The last session ended without saving. What was cut of &quot;%1&quot; can be brought back, now or later with File, Recover.</source>
        <translation>前回は保存されずに終わりました。切削した「%1」を、今すぐ、または後で「ファイル」の「復元」から復元できます。</translation>
    </message>
    <message>
        <source>The last session ended without saving, and the disk is full: &quot;%1&quot; can be brought back once %2 MB are free where %3 is (now %4 MB). Nothing is lost. Make room, then try again.</source>
        <translation>前回は保存されずに終わりましたが、ディスクの空きが足りません。%3 のあるディスクに %2 MB の空きができれば（現在 %4 MB）「%1」を復元できます。失われたものはありません。空きをつくってから、もう一度お試しください。</translation>
    </message>
    <message>
        <source>The tooth can be touched now, and cut once it is prepared (%1 % done).</source>
        <translation>今は歯に触れることができます。準備ができれば切削できます（%1 % 完了）。</translation>
    </message>
    <message>
        <source>Your code goes into what you save from now on. This recording began without it.</source>
        <translation>受講者コードは、これから保存するものに書き込まれます。今の記録はコードなしで始まっています。</translation>
    </message>
    <message>
        <source>There is no picture. Everything else goes on. Technical detail: %1</source>
        <translation>画像を表示できません。ほかの機能はすべて使えます。技術的な詳細：%1</translation>
    </message>
    <message>
        <source>%1 %2 The mouse holds the handpiece now; nothing that was cut is lost.</source>
        <translation>%1%2 いまはマウスでハンドピースを動かします。切削した内容は失われていません。</translation>
    </message>
    <message>
        <source>The school&apos;s settings have a mistake. Technical detail: %1</source>
        <translation>学校の設定に誤りがあります。技術情報：%1</translation>
    </message>
    <message>
        <source>%1 %2 The mouse holds the handpiece.</source>
        <translation>%1%2 マウスでハンドピースを動かします。</translation>
    </message>
    <message>
        <source>The device gives no force. %1 %2</source>
        <translation>デバイスは力を出していません。%1%2</translation>
    </message>
    <message>
        <source>The pulp is exposed.</source>
        <translation>露髄しました。</translation>
    </message>
    <message>
        <source>%1 %2 The button alone is the pedal.</source>
        <translation>%1 %2 ボタンだけがペダルになります。</translation>
    </message>
    <message>
        <source>The foot pedal %1 was unplugged: it is up. Plugged in again, it counts once it has been up.</source>
        <translation>フットペダル %1 が抜かれました。ペダルは上がっているものとします。つなぎ直すと、一度上げてから有効になります。</translation>
    </message>
    <message>
        <source>Not in this exercise: %1.</source>
        <translation>この課題では使えません: %1。</translation>
    </message>
    <message>
        <source>Handed in: %1, with its tooth. Recordings in it: %2 (%3 MB).</source>
        <translation>提出しました: %1（歯を含む）。含まれる記録: %2（%3 MB）。</translation>
    </message>
    <message>
        <source>Handed in: %1, with its tooth. Recordings in it: %2 (%3 MB). Recordings that are no longer there, or too large together, and not in it: %4.</source>
        <translation>提出しました: %1（歯を含む）。含まれる記録: %2（%3 MB）。もう存在しないか、合計が大きすぎて含まれない記録: %4。</translation>
    </message>
    <message>
        <source>Reconnect</source>
        <translation>再接続</translation>
    </message>
    <message>
        <source>Try again</source>
        <translation>もう一度</translation>
    </message>
    <message>
        <source>Bring it back</source>
        <translation>復元する</translation>
    </message>
    <message>
        <source>Not now</source>
        <translation>後で</translation>
    </message>
    <message>
        <source>Save as...</source>
        <translation>名前を付けて保存...</translation>
    </message>
    <message>
        <source>Not all of %1 was taken as it is. Technical detail: %2</source>
        <translation>%1 の一部はそのまま読み込まれていません。技術的な詳細：%2</translation>
    </message>
    <message>
        <source>What was kept at %1 could not be used: it is made anew.</source>
        <translation>%1 に保存されていたものは使えないため、作り直します。</translation>
    </message>
    <message>
        <source>The tooth cannot be kept in %1: the next start makes it again. %2</source>
        <translation>歯を %1 に保存できません。次に起動したときにもう一度作ります。%2</translation>
    </message>
    <message>
        <source>The %1 minutes of this exercise are over. You can go on; the result says by how much.</source>
        <translation>この課題の制限時間 %1 分が過ぎました。続けられますが、超過した時間が結果に示されます。</translation>
    </message>
    <message>
        <source>The %1 minutes of this exercise are over: the pedal is dead. Finish to see the result.</source>
        <translation>この課題の制限時間 %1 分が過ぎたため、ペダルは効きません。「完了」を押すと結果が出ます。</translation>
    </message>
    <message>
        <source>An exam runs: no other work can be opened or kept until it is handed over.</source>
        <translation>試験中です。提出するまで、ほかの作業を開いたり保存したりできません。</translation>
    </message>
</context>
<context>
    <name>Overlay</name>
    <message>
        <source>Removed</source>
        <translation>切削深さ</translation>
    </message>
    <message>
        <source>%1 mm</source>
        <translation>%1 mm</translation>
    </message>
    <message>
        <source>lifted</source>
        <translation>退避</translation>
    </message>
    <message>
        <source>down</source>
        <translation>オン</translation>
    </message>
    <message>
        <source>up</source>
        <translation>オフ</translation>
    </message>
    <message>
        <source>Pedal</source>
        <translation>ペダル</translation>
    </message>
    <message>
        <source>Load</source>
        <translation>荷重</translation>
    </message>
    <message>
        <source>%1 N</source>
        <translation>%1 N</translation>
    </message>
    <message>
        <source>off</source>
        <translation>なし</translation>
    </message>
    <message>
        <source>Finger rest</source>
        <translation>フィンガーレスト</translation>
    </message>
    <message>
        <source>Thinnest: %1</source>
        <translation>最も薄い所：%1</translation>
    </message>
    <message>
        <source>Before</source>
        <translation>切削前</translation>
    </message>
    <message>
        <source>Now</source>
        <translation>現在</translation>
    </message>
    <message>
        <source>stays down</source>
        <translation>踏んだまま</translation>
    </message>
    <message>
        <source>Bur</source>
        <translation>バー</translation>
    </message>
    <message>
        <source>Depth stop</source>
        <translation>深さ制限</translation>
    </message>
    <message>
        <source>Pass</source>
        <translation>1回の深さ</translation>
    </message>
</context>
<context>
    <name>Press</name>
    <message>
        <source>Not pressed</source>
        <translation>押していません</translation>
    </message>
    <message>
        <source>Very light</source>
        <translation>とても軽い</translation>
    </message>
    <message>
        <source>Light</source>
        <translation>軽い</translation>
    </message>
    <message>
        <source>As usual</source>
        <translation>普通</translation>
    </message>
    <message>
        <source>Firm</source>
        <translation>やや強い</translation>
    </message>
    <message>
        <source>Hard</source>
        <translation>強い</translation>
    </message>
</context>
<context>
    <name>Problem</name>
    <message>
        <source>The mouth has no tooth %1.</source>
        <translation>この口腔に歯 %1 はありません。</translation>
    </message>
    <message>
        <source>Choose one of the teeth that the chart shows.</source>
        <translation>チャートに表示されている歯を選択してください。</translation>
    </message>
    <message>
        <source>There is no such file.</source>
        <translation>ファイルが見つかりません。</translation>
    </message>
    <message>
        <source>Check the name, or choose the file again.</source>
        <translation>名前を確かめるか、ファイルを選び直してください。</translation>
    </message>
    <message>
        <source>This is a folder, not a file.</source>
        <translation>これはファイルではなくフォルダーです。</translation>
    </message>
    <message>
        <source>This is a device or a pipe, not a plain file.</source>
        <translation>これは通常のファイルではなく、デバイスまたはパイプです。</translation>
    </message>
    <message>
        <source>Choose a file.</source>
        <translation>ファイルを選んでください。</translation>
    </message>
    <message>
        <source>Choose a file inside it.</source>
        <translation>フォルダーの中のファイルを選んでください。</translation>
    </message>
    <message>
        <source>This folder holds no case: it has no %1.</source>
        <translation>このフォルダーは症例ではありません。%1 がありません。</translation>
    </message>
    <message>
        <source>Choose a folder with case.toml, a .handpiece file or an STL file.</source>
        <translation>case.toml のあるフォルダー、.handpiece ファイル、または STL ファイルを選んでください。</translation>
    </message>
    <message>
        <source>The file cannot be read: %1.</source>
        <translation>ファイルを読み込めません：%1。</translation>
    </message>
    <message>
        <source>Check its permissions.</source>
        <translation>アクセス権を確かめてください。</translation>
    </message>
    <message>
        <source>The disk is full: %1. Nothing is lost, the tooth is still open.</source>
        <translation>ディスクがいっぱいです：%1。何も失われていません。歯は開いたままです。</translation>
    </message>
    <message>
        <source>Make room, or save to another disk.</source>
        <translation>空きを作るか、別のディスクに保存してください。</translation>
    </message>
    <message>
        <source>This place cannot be written: %1. Nothing is lost, the tooth is still open.</source>
        <translation>この場所には書き込めません：%1。何も失われていません。歯は開いたままです。</translation>
    </message>
    <message>
        <source>Save under another name or in another folder.</source>
        <translation>別の名前で、または別のフォルダーに保存してください。</translation>
    </message>
    <message>
        <source>Take another copy of it.</source>
        <translation>別の写しを使ってください。</translation>
    </message>
    <message>
        <source>This file holds no surface.</source>
        <translation>このファイルには曲面がありません。</translation>
    </message>
    <message>
        <source>Choose an STL, PLY or OBJ file of a tooth.</source>
        <translation>歯の STL、PLY または OBJ ファイルを選んでください。</translation>
    </message>
    <message>
        <source>Mend it first: handpiece mesh repair FILE MENDED.stl</source>
        <translation>先に修復してください：handpiece mesh repair FILE MENDED.stl</translation>
    </message>
    <message>
        <source>%1 mm is no size for a tooth.</source>
        <translation>%1 mm は歯の大きさではありません。</translation>
    </message>
    <message>
        <source>The file&apos;s unit is probably not the millimetre: scale it first.</source>
        <translation>ファイルの単位がミリメートルではないようです。先に寸法を直してください。</translation>
    </message>
    <message>
        <source>The tooth that was cut is no longer at %1.</source>
        <translation>切削した歯が %1 に見つかりません。</translation>
    </message>
    <message>
        <source>Put it back there, or open an attempt that was saved as one .handpiece file.</source>
        <translation>元の場所に戻すか、.handpiece ファイルとして保存した作業を開いてください。</translation>
    </message>
    <message>
        <source>The tooth at %1 has changed since: it is another tooth now.</source>
        <translation>%1 の歯はその後変更され、別の歯になっています。</translation>
    </message>
    <message>
        <source>Put the one that was cut back there.</source>
        <translation>切削した歯を元の場所に戻してください。</translation>
    </message>
    <message>
        <source>This is no recorded session.</source>
        <translation>これは実習の記録ではありません。</translation>
    </message>
    <message>
        <source>Sessions are files that end in .h5.</source>
        <translation>実習の記録は .h5 で終わるファイルです。</translation>
    </message>
    <message>
        <source>Nothing was recorded in this session.</source>
        <translation>この実習では何も記録されていません。</translation>
    </message>
    <message>
        <source>It ended before its first second was over.</source>
        <translation>始まってから 1 秒たたないうちに終わりました。</translation>
    </message>
    <message>
        <source>Install libegl-mesa0 and libgl1-mesa-dri. Everything but the picture goes on.</source>
        <translation>libegl-mesa0 と libgl1-mesa-dri をインストールしてください。歯の画面以外はこのまま使えます。</translation>
    </message>
    <message>
        <source>The tooth you opened is no longer at %1. Nothing that was cut is lost.</source>
        <translation>開いた歯が %1 に見つかりません。切削した内容は失われていません。</translation>
    </message>
    <message>
        <source>Save as a .handpiece file: it takes the tooth along.</source>
        <translation>.handpiece ファイルとして保存すると、歯も一緒に保存されます。</translation>
    </message>
    <message>
        <source>There is no attempt to resume yet.</source>
        <translation>続きから始められる作業はまだありません。</translation>
    </message>
    <message>
        <source>Save what you cut with File, Save: the next start finds it.</source>
        <translation>「ファイル」の「保存」で保存すると、次回から見つけられます。</translation>
    </message>
    <message>
        <source>The convex hull knows the whole tooth only, and this one is cut.</source>
        <translation>凸包は切削前の歯にしか使えませんが、この歯は削られています。</translation>
    </message>
    <message>
        <source>Reset the tooth first.</source>
        <translation>先に歯を最初の状態に戻してください。</translation>
    </message>
    <message>
        <source>The voxel size cannot change while the bur is at work.</source>
        <translation>切削中はボクセルの大きさを変えられません。</translation>
    </message>
    <message>
        <source>Lift the bur first.</source>
        <translation>先にバーを上げてください。</translation>
    </message>
    <message>
        <source>Nothing is being recorded.</source>
        <translation>何も記録されていません。</translation>
    </message>
    <message>
        <source>Open a tooth first: its recording begins by itself.</source>
        <translation>先に歯を開いてください。記録は自動で始まります。</translation>
    </message>
    <message>
        <source>The voxel size of a tooth that was cut before this recording cannot change.</source>
        <translation>この記録より前に切削した歯では、ボクセルの大きさを変えられません。</translation>
    </message>
    <message>
        <source>Reset the tooth, or open the case anew, and choose the size before cutting.</source>
        <translation>歯を最初の状態に戻すか、症例を開き直して、切削の前に大きさを選んでください。</translation>
    </message>
    <message>
        <source>No tooth is open.</source>
        <translation>歯が開かれていません。</translation>
    </message>
    <message>
        <source>Open a case or a starter tooth first.</source>
        <translation>先に症例か練習用の歯を開いてください。</translation>
    </message>
    <message>
        <source>This kind of file cannot be opened.</source>
        <translation>この種類のファイルは開けません。</translation>
    </message>
    <message>
        <source>Cases are folders, .handpiece, .stl, .ply or .obj files; sessions are .h5 files.</source>
        <translation>症例はフォルダーか .handpiece、.stl、.ply、.obj ファイル、実習の記録は .h5 ファイルです。</translation>
    </message>
    <message>
        <source>The file is too large to be read.</source>
        <translation>ファイルが大きすぎて読み込めません。</translation>
    </message>
    <message>
        <source>Choose another file.</source>
        <translation>別のファイルを選んでください。</translation>
    </message>
    <message>
        <source>This case names no surface of a whole tooth.</source>
        <translation>このケースには歯全体の表面が指定されていません。</translation>
    </message>
    <message>
        <source>Name the tooth in case.toml: outer.stl, or one part.</source>
        <translation>case.toml に歯を指定してください（outer.stl または一つの部品）。</translation>
    </message>
    <message>
        <source>This is no attempt that was saved.</source>
        <translation>これは保存された実習ではありません。</translation>
    </message>
    <message>
        <source>Choose the folder or .handpiece file that was saved.</source>
        <translation>保存したフォルダーまたは .handpiece ファイルを選んでください。</translation>
    </message>
    <message>
        <source>What was cut in this attempt cannot be read: it is damaged.</source>
        <translation>この実習の切削内容は壊れていて読み込めません。</translation>
    </message>
    <message>
        <source>Mend the file, or take another copy of it.</source>
        <translation>ファイルを直すか、別のコピーを使ってください。</translation>
    </message>
    <message>
        <source>Export it again as an STL, PLY or OBJ file.</source>
        <translation>STL、PLY または OBJ ファイルとして書き出し直してください。</translation>
    </message>
    <message>
        <source>The surface is not closed. Open edges: %1, holes: %2, the first at %3.</source>
        <translation>表面が閉じていません。開いた辺：%1、穴：%2、最初の位置：%3。</translation>
    </message>
    <message>
        <source>The surface forks. Edges of more than two faces: %1, the first at %2.</source>
        <translation>表面が枝分かれしています。三つ以上の面が接する辺：%1、最初の位置：%2。</translation>
    </message>
    <message>
        <source>The surface has only one side.</source>
        <translation>表面に裏表がありません。</translation>
    </message>
    <message>
        <source>Draw it anew in a mesh editor.</source>
        <translation>メッシュ編集ソフトで作り直してください。</translation>
    </message>
    <message>
        <source>The surface is turned inside out in places. Places: %1, the first at %2.</source>
        <translation>表面の一部が裏返っています。箇所：%1、最初の位置：%2。</translation>
    </message>
    <message>
        <source>The surface encloses no volume.</source>
        <translation>表面が体積を囲んでいません。</translation>
    </message>
    <message>
        <source>Choose the closed surface of a tooth.</source>
        <translation>閉じた歯の表面を選んでください。</translation>
    </message>
    <message>
        <source>The surface crosses itself. Pairs of faces: %1, the first at %2.</source>
        <translation>表面が自分自身と交差しています。面の組：%1、最初の位置：%2。</translation>
    </message>
    <message>
        <source>This session was recorded by a newer Handpiece.</source>
        <translation>この記録は新しい版の Handpiece で作られています。</translation>
    </message>
    <message>
        <source>Open it with that one.</source>
        <translation>その版で開いてください。</translation>
    </message>
    <message>
        <source>This session has a gap: the disk was too slow.</source>
        <translation>この記録には欠けた部分があります。ディスクが遅すぎました。</translation>
    </message>
    <message>
        <source>Go on behind the gap, or export it as a table.</source>
        <translation>欠けた部分の後から再生するか、表として書き出してください。</translation>
    </message>
    <message>
        <source>What somebody else made is not opened on this computer. Technical detail: %1</source>
        <translation>このコンピュータでは、ほかの人が作ったファイルは開きません。技術的な詳細：%1</translation>
    </message>
    <message>
        <source>Your own work can be opened. For the rest the system needs Linux 5.13 or later with Landlock, and all of the program.</source>
        <translation>ご自分の作業は開けます。それ以外を開くには、Landlock が使える Linux 5.13 以降と、プログラム一式が必要です。</translation>
    </message>
    <message>
        <source>The program that was reading this file was ended.</source>
        <translation>このファイルを読んでいたプログラムが終了させられました。</translation>
    </message>
    <message>
        <source>Open it again.</source>
        <translation>もう一度開いてください。</translation>
    </message>
    <message>
        <source>This file ended the program that reads it first. Technical detail: %1</source>
        <translation>このファイルを先に読むプログラムが、読んでいる途中で異常終了しました。技術的な詳細：%1</translation>
    </message>
    <message>
        <source>It is damaged, or was made to do this: take another copy of it.</source>
        <translation>壊れているか、そうなるように作られたファイルです。別の写しを使ってください。</translation>
    </message>
    <message>
        <source>The exercise, or its rubric, cannot be read. Technical detail: %1</source>
        <translation>課題、またはそのルーブリックを読めません。技術的な詳細：%1</translation>
    </message>
    <message>
        <source>Reading this file takes longer than anybody&apos;s work may.</source>
        <translation>このファイルを読むのに、作業として許される時間を超えました。</translation>
    </message>
    <message>
        <source>Reading this file takes more memory than anybody&apos;s work may.</source>
        <translation>このファイルを読むのに、作業として許されるメモリを超えました。</translation>
    </message>
    <message>
        <source>%1 mm is no size for a bur.</source>
        <translation>%1 mm はバーの大きさではありません。</translation>
    </message>
    <message>
        <source>This bur is not round about z, tip down.</source>
        <translation>このバーは z 軸まわりに丸くなっていません（先端は下向き）。</translation>
    </message>
    <message>
        <source>Turn it so in a mesh editor. A bur is a solid of revolution.</source>
        <translation>メッシュ編集ソフトで向きを直してください。バーは回転体です。</translation>
    </message>
    <message>
        <source>The bur&apos;s surface is not closed.</source>
        <translation>バーの表面が閉じていません。</translation>
    </message>
    <message>
        <source>There is no bur %1.</source>
        <translation>%1 というバーはありません。</translation>
    </message>
    <message>
        <source>Choose one in the list.</source>
        <translation>一覧から選んでください。</translation>
    </message>
    <message>
        <source>Choose a value from %3 to %4.</source>
        <translation>%3 から %4 までの値を選んでください。</translation>
    </message>
    <message>
        <source>There is no microphone.</source>
        <translation>マイクがありません。</translation>
    </message>
    <message>
        <source>Connect one, and allow the program to use it.</source>
        <translation>マイクを接続し、このプログラムに使用を許可してください。</translation>
    </message>
    <message>
        <source>There is no sound card. Everything but the sound goes on.</source>
        <translation>サウンドカードがありません。音のほかはすべて使えます。</translation>
    </message>
    <message>
        <source>Connect one and check the settings of the desktop.</source>
        <translation>接続して、デスクトップの設定を確かめてください。</translation>
    </message>
    <message>
        <source>This is no WAV file that can be read.</source>
        <translation>これは読み込める WAV ファイルではありません。</translation>
    </message>
    <message>
        <source>Save the sound as WAV with one or two channels, PCM of 16 or 24 bits.</source>
        <translation>音を 1 または 2 チャンネル、16 または 24 ビット PCM の WAV で保存してください。</translation>
    </message>
    <message>
        <source>The rate of this recording cannot be used.</source>
        <translation>この録音のサンプリング周波数は使えません。</translation>
    </message>
    <message>
        <source>Record with 48,000 samples a second.</source>
        <translation>毎秒 48,000 サンプルで録音してください。</translation>
    </message>
    <message>
        <source>The recording is too long.</source>
        <translation>録音が長すぎます。</translation>
    </message>
    <message>
        <source>Cut out up to a minute in which the handpiece runs evenly.</source>
        <translation>ハンドピースが一定に回っている部分を、1 分以内で切り出してください。</translation>
    </message>
    <message>
        <source>The recording is too short.</source>
        <translation>録音が短すぎます。</translation>
    </message>
    <message>
        <source>A tenth of a second is the least.</source>
        <translation>少なくとも 0.1 秒は必要です。</translation>
    </message>
    <message>
        <source>The recording is silent.</source>
        <translation>録音に音が入っていません。</translation>
    </message>
    <message>
        <source>Check the microphone and its level.</source>
        <translation>マイクと入力レベルを確かめてください。</translation>
    </message>
    <message>
        <source>There is no OpenGL 3.3 to draw with.</source>
        <translation>描画に使える OpenGL 3.3 がありません。</translation>
    </message>
    <message>
        <source>The graphics card has no memory left.</source>
        <translation>グラフィックスカードのメモリーが足りません。</translation>
    </message>
    <message>
        <source>Choose a lower picture quality or a smaller window.</source>
        <translation>画質を下げるか、ウィンドウを小さくしてください。</translation>
    </message>
    <message>
        <source>The simulation has stopped. Technical detail: %1</source>
        <translation>シミュレーションが止まりました。技術的な詳細：%1</translation>
    </message>
    <message>
        <source>Save what was cut, then open the tooth again.</source>
        <translation>切削した歯を保存してから、もう一度開いてください。</translation>
    </message>
    <message>
        <source>Technical detail: %1</source>
        <translation>技術的な詳細：%1</translation>
    </message>
    <message>
        <source>Technical advice: %1</source>
        <translation>技術的な助言：%1</translation>
    </message>
    <message>
        <source>Its text cannot be understood. Technical detail: %1</source>
        <translation>内容を解釈できません。技術的な詳細：%1</translation>
    </message>
    <message>
        <source>This is no .handpiece file, or a damaged one. Technical detail: %1</source>
        <translation>これは .handpiece ファイルではないか、壊れています。技術的な詳細：%1</translation>
    </message>
    <message>
        <source>This file holds no mesh that can be read. Technical detail: %1</source>
        <translation>このファイルには読み込めるメッシュがありません。技術的な詳細：%1</translation>
    </message>
    <message>
        <source>This session is damaged. Technical detail: %1</source>
        <translation>この記録は壊れています。技術的な詳細：%1</translation>
    </message>
    <message>
        <source>This value cannot be set: %2.</source>
        <translation>この値は設定できません：%2。</translation>
    </message>
    <message>
        <source>There is no scan in it. What was found: %1.</source>
        <translation>この中にスキャンがありません。見つかったもの：%1。</translation>
    </message>
    <message>
        <source>Choose a folder, ZIP or file with slices (DICOM, TIFF, PNG, JPEG, BMP), NRRD, NIfTI, MetaImage, or raw numbers with a scan.toml.</source>
        <translation>スライス（DICOM、TIFF、PNG、JPEG、BMP）、NRRD、NIfTI、MetaImage、または scan.toml を添えた生データのフォルダー、ZIP、ファイルを選んでください。</translation>
    </message>
    <message>
        <source>The scan does not tell how large its voxels are.</source>
        <translation>スキャンにボクセルの大きさが書かれていません。</translation>
    </message>
    <message>
        <source>Type the size of a voxel: the scanner&apos;s record has it.</source>
        <translation>ボクセルの大きさを入力してください。撮影装置の記録にあります。</translation>
    </message>
    <message>
        <source>It is larger than a scan of a tooth can be, or its header is damaged.</source>
        <translation>歯のスキャンとしては大きすぎるか、ヘッダーが壊れています。</translation>
    </message>
    <message>
        <source>Crop the scan around the tooth, or take another copy of it.</source>
        <translation>歯の周りだけを切り出すか、別のコピーを使ってください。</translation>
    </message>
    <message>
        <source>No tooth was found in the scan. Technical detail: %1</source>
        <translation>スキャンに歯が見つかりません。技術的な詳細：%1</translation>
    </message>
    <message>
        <source>Choose the series that shows the tooth, or set the thresholds by hand.</source>
        <translation>歯が写っているシリーズを選ぶか、しきい値を手動で決めてください。</translation>
    </message>
    <message>
        <source>None of the labels is of a tooth.</source>
        <translation>歯のラベルがひとつもありません。</translation>
    </message>
    <message>
        <source>Tell what the file&apos;s numbers mean: 1 caries, 2 enamel, 3 dentine, 4 pulp, 5 restoration.</source>
        <translation>ファイルの番号が何を表すかを指定してください：1 う蝕、2 エナメル質、3 象牙質、4 歯髄、5 修復物。</translation>
    </message>
    <message>
        <source>The numbers of these labels do not tell which tooth is which.</source>
        <translation>このラベルの番号からは、どれがどの歯か分かりません。</translation>
    </message>
    <message>
        <source>Choose under &quot;What the numbers mean&quot; how they count.</source>
        <translation>「番号の意味」で、番号の付け方を選んでください。</translation>
    </message>
    <message>
        <source>This file holds %1 whole numbers and nothing between them: labels, not grey values.</source>
        <translation>このファイルには %1 種類の整数だけがあり、中間の値がありません。濃度値ではなくラベルです。</translation>
    </message>
    <message>
        <source>Tick &quot;These are tissues already, not grey values&quot;, and choose what the numbers mean.</source>
        <translation>「濃度値ではなく、組織のラベルである」に印を付け、番号の意味を選んでください。</translation>
    </message>
    <message>
        <source>In the scan the teeth are not where the labels have them.</source>
        <translation>スキャンの歯の位置が、ラベルと合いません。</translation>
    </message>
    <message>
        <source>Choose the scan that the labels were made from, or do without.</source>
        <translation>ラベルの元になったスキャンを選ぶか、使わずに進めてください。</translation>
    </message>
    <message>
        <source>These labels tell jaws and rows of teeth, but not one tooth from the next.</source>
        <translation>このラベルは顎と歯列を区別していますが、一本ずつの歯は区別していません。</translation>
    </message>
    <message>
        <source>Use labels of single teeth, by FDI numbers 11 to 48.</source>
        <translation>FDI の番号（11〜48）で一本ずつの歯を表すラベルを使ってください。</translation>
    </message>
    <message>
        <source>There is no tooth %1 in the labels.</source>
        <translation>ラベルに歯 %1 はありません。</translation>
    </message>
    <message>
        <source>Choose one of %2.</source>
        <translation>%2 から選んでください。</translation>
    </message>
    <message>
        <source>The tooth is cut off by the border of the scan.</source>
        <translation>歯がスキャンの端で切れています。</translation>
    </message>
    <message>
        <source>Choose another tooth, or a scan that shows all of it.</source>
        <translation>別の歯を選ぶか、歯の全体が写っているスキャンを使ってください。</translation>
    </message>
    <message>
        <source>There is no tooth at the place that was pointed at.</source>
        <translation>指した場所に歯がありません。</translation>
    </message>
    <message>
        <source>Point at the crown or a root of a tooth.</source>
        <translation>歯冠か歯根を指してください。</translation>
    </message>
    <message>
        <source>The scan is too coarse: voxels of %1 mm cannot show enamel and pulp.</source>
        <translation>スキャンが粗すぎます。%1 mm のボクセルではエナメル質と歯髄を見分けられません。</translation>
    </message>
    <message>
        <source>Use a scan of %2 mm or finer.</source>
        <translation>%2 mm 以下のスキャンを使ってください。</translation>
    </message>
    <message>
        <source>The case is saved, but its report is not. %1</source>
        <translation>症例は保存しましたが、レポートは保存できませんでした。%1</translation>
    </message>
    <message>
        <source>Save the case again, or in another folder.</source>
        <translation>症例をもう一度保存するか、別のフォルダーに保存してください。</translation>
    </message>
    <message>
        <source>There is no program that shows this page.</source>
        <translation>このページを表示するプログラムがありません。</translation>
    </message>
    <message>
        <source>Open the file with a web browser.</source>
        <translation>ウェブブラウザーでファイルを開いてください。</translation>
    </message>
    <message>
        <source>The software of the device&apos;s maker was not found: %1.</source>
        <translation>デバイスの製造元のソフトウェアが見つかりません：%1。</translation>
    </message>
    <message>
        <source>Install the maker&apos;s driver and library, then choose the device again.</source>
        <translation>製造元のドライバーとライブラリをインストールし、もう一度デバイスを選んでください。</translation>
    </message>
    <message>
        <source>The maker&apos;s library is of another version: %1 has no %2.</source>
        <translation>製造元のライブラリの版が違います：%1 に %2 がありません。</translation>
    </message>
    <message>
        <source>Install the version that docs/devices.md names.</source>
        <translation>docs/devices.md にある版をインストールしてください。</translation>
    </message>
    <message>
        <source>Two libraries want the same device: %1 and %2.</source>
        <translation>二つのライブラリが同じデバイスを使おうとしています：%1 と %2。</translation>
    </message>
    <message>
        <source>Name the one that is meant in HANDPIECE_HD_LIBRARY and start again.</source>
        <translation>使う方を HANDPIECE_HD_LIBRARY に指定し、起動し直してください。</translation>
    </message>
    <message>
        <source>There is no device called %1.</source>
        <translation>%1 という名前のデバイスはありません。</translation>
    </message>
    <message>
        <source>Choose one in the menu Device.</source>
        <translation>メニュー「デバイス」から選んでください。</translation>
    </message>
    <message>
        <source>The device is not there: %1.</source>
        <translation>デバイスがありません：%1。</translation>
    </message>
    <message>
        <source>Check its cable and power, then connect it again.</source>
        <translation>ケーブルと電源を確かめ、もう一度接続してください。</translation>
    </message>
    <message>
        <source>The device is in use already: %1.</source>
        <translation>デバイスはすでに使われています：%1。</translation>
    </message>
    <message>
        <source>Close the other program that uses it.</source>
        <translation>それを使っているほかのプログラムを閉じてください。</translation>
    </message>
    <message>
        <source>This account may not use the device: %1.</source>
        <translation>このアカウントにはデバイスを使う権限がありません：%1。</translation>
    </message>
    <message>
        <source>Install the udev rules (docs/devices.md), then plug it in again.</source>
        <translation>udev の規則をインストールし（docs/devices.md）、つなぎ直してください。</translation>
    </message>
    <message>
        <source>%1 reports an error: %2</source>
        <translation>%1 がエラーを報告しています：%2</translation>
    </message>
    <message>
        <source>Switch the device off and on, then choose it again.</source>
        <translation>デバイスの電源を入れ直し、もう一度選んでください。</translation>
    </message>
    <message>
        <source>The maker&apos;s library does not answer.</source>
        <translation>製造元のライブラリが応答しません。</translation>
    </message>
    <message>
        <source>Switch the device off and on and start Handpiece again.</source>
        <translation>デバイスの電源を入れ直し、Handpiece を起動し直してください。</translation>
    </message>
    <message>
        <source>The Haply service at %1 does not answer.</source>
        <translation>%1 の Haply サービスが応答しません。</translation>
    </message>
    <message>
        <source>Start Haply Hub, then choose the device again.</source>
        <translation>Haply Hub を起動し、もう一度デバイスを選んでください。</translation>
    </message>
    <message>
        <source>The device&apos;s service is not running at %1: %2.</source>
        <translation>デバイスのサービスが %1 で動いていません：%2。</translation>
    </message>
    <message>
        <source>Start it (Haply Hub), then choose the device again.</source>
        <translation>サービス（Haply Hub）を起動し、もう一度デバイスを選んでください。</translation>
    </message>
    <message>
        <source>The service at %1 sends what cannot be read.</source>
        <translation>%1 のサービスから読めないデータが届いています。</translation>
    </message>
    <message>
        <source>Update Haply Hub.</source>
        <translation>Haply Hub を更新してください。</translation>
    </message>
    <message>
        <source>The service of the SpaceMouse is not running: %1.</source>
        <translation>SpaceMouse のサービスが動いていません：%1。</translation>
    </message>
    <message>
        <source>Install and start spacenavd, then choose the device again.</source>
        <translation>spacenavd をインストールして起動し、もう一度デバイスを選んでください。</translation>
    </message>
    <message>
        <source>The device&apos;s settings are those of another device: %1.</source>
        <translation>デバイスの設定が別のデバイスのものです：%1。</translation>
    </message>
    <message>
        <source>Take the file away, then set the device up.</source>
        <translation>ファイルを取り除き、デバイスの準備をしてください。</translation>
    </message>
    <message>
        <source>The device has not told where it is yet.</source>
        <translation>デバイスがまだ位置を知らせていません。</translation>
    </message>
    <message>
        <source>Check its cable and power; some must be calibrated first.</source>
        <translation>ケーブルと電源を確認してください。先に校正が必要な機種もあります。</translation>
    </message>
    <message>
        <source>The device is gone.</source>
        <translation>デバイスがなくなりました。</translation>
    </message>
    <message>
        <source>Check its cable and power.</source>
        <translation>ケーブルと電源を確かめてください。</translation>
    </message>
    <message>
        <source>The device&apos;s own software reports an error (%1).</source>
        <translation>デバイスのソフトウェアがエラーを報告しています（%1）。</translation>
    </message>
    <message>
        <source>Switch the device off and on.</source>
        <translation>デバイスの電源を入れ直してください。</translation>
    </message>
    <message>
        <source>The device sends what cannot be read.</source>
        <translation>デバイスから読めないデータが届いています。</translation>
    </message>
    <message>
        <source>Start its service again, or update it.</source>
        <translation>サービスを起動し直すか、更新してください。</translation>
    </message>
    <message>
        <source>The device has stopped telling where it is.</source>
        <translation>デバイスが位置を知らせなくなりました。</translation>
    </message>
    <message>
        <source>Check its cable; close other programs that use it.</source>
        <translation>ケーブルを確かめ、それを使っているほかのプログラムを閉じてください。</translation>
    </message>
    <message>
        <source>The simulation stood still.</source>
        <translation>シミュレーションが止まっていました。</translation>
    </message>
    <message>
        <source>Close other programs; the force comes back by itself.</source>
        <translation>ほかのプログラムを閉じてください。力は自動で戻ります。</translation>
    </message>
    <message>
        <source>The device told a place that is no number.</source>
        <translation>デバイスの知らせた位置が数ではありません。</translation>
    </message>
    <message>
        <source>Lift the bur off the tooth; calibrate the device.</source>
        <translation>バーを歯から離し、デバイスを校正してください。</translation>
    </message>
    <message>
        <source>The stylus jumped farther than a hand can move.</source>
        <translation>スタイラスが手では動かせないほど大きく飛びました。</translation>
    </message>
    <message>
        <source>The device is not calibrated.</source>
        <translation>デバイスが校正されていません。</translation>
    </message>
    <message>
        <source>Calibrate it: Device, Set up...</source>
        <translation>校正してください：「デバイス」→「準備」...</translation>
    </message>
    <message>
        <source>The device&apos;s motors are too warm.</source>
        <translation>デバイスのモーターが熱くなりすぎています。</translation>
    </message>
    <message>
        <source>Let it rest for some minutes.</source>
        <translation>数分間休ませてください。</translation>
    </message>
    <message>
        <source>Nobody holds the stylus.</source>
        <translation>スタイラスを誰も持っていません。</translation>
    </message>
    <message>
        <source>Take it in the hand.</source>
        <translation>手に取ってください。</translation>
    </message>
    <message>
        <source>The device was stopped.</source>
        <translation>デバイスが停止されました。</translation>
    </message>
    <message>
        <source>Choose it again in the menu Device.</source>
        <translation>メニュー「デバイス」からもう一度選んでください。</translation>
    </message>
    <message>
        <source>The maker&apos;s library asks for a licence: %1.</source>
        <translation>製造元のライブラリがライセンスを求めています：%1。</translation>
    </message>
    <message>
        <source>Install the licence with the maker&apos;s program, then choose the device again.</source>
        <translation>製造元のプログラムでライセンスを入れ、もう一度デバイスを選んでください。</translation>
    </message>
    <message>
        <source>The faults to inject cannot be read: %1 (character %2).</source>
        <translation>入れる不具合の指定が読めません：%1（%2文字目）。</translation>
    </message>
    <message>
        <source>Write for instance unplug@2.5, stall@3:0.2.</source>
        <translation>たとえば unplug@2.5, stall@3:0.2 と書いてください。</translation>
    </message>
    <message>
        <source>The placing of the device cannot be used: %1.</source>
        <translation>デバイスの配置が使えません：%1。</translation>
    </message>
    <message>
        <source>Set the device up again: Device, Set up...</source>
        <translation>設定し直してください：デバイス、設定...</translation>
    </message>
    <message>
        <source>The device runs already.</source>
        <translation>デバイスはすでに動いています。</translation>
    </message>
    <message>
        <source>The firmware of the Falcon %1 is not loaded, and Handpiece may not bring it along.</source>
        <translation>Falcon %1 のファームウェアが読み込まれていません。Handpieceには付属できません。</translation>
    </message>
    <message>
        <source>Install the Force Dimension SDK, or name the maker&apos;s file in HANDPIECE_FALCON_FIRMWARE.</source>
        <translation>Force DimensionのSDKを入れるか、HANDPIECE_FALCON_FIRMWARE に製造元のファイルを指定してください。</translation>
    </message>
    <message>
        <source>The Falcon %1 does not take its firmware.</source>
        <translation>Falcon %1 がファームウェアを受け付けません。</translation>
    </message>
    <message>
        <source>Switch it off and on; check HANDPIECE_FALCON_FIRMWARE.</source>
        <translation>電源を入れ直し、HANDPIECE_FALCON_FIRMWARE を確かめてください。</translation>
    </message>
    <message>
        <source>The device&apos;s record has a value that cannot be: %1 of %2.</source>
        <translation>デバイスの記録にあり得ない値があります：%1、%2。</translation>
    </message>
    <message>
        <source>Take the device&apos;s settings away, then set it up again.</source>
        <translation>デバイスの設定ファイルを取り除き、設定し直してください。</translation>
    </message>
    <message>
        <source>Haply&apos;s service is set to turn or scale the arm&apos;s movements.</source>
        <translation>Haplyのサービスがアームの動きを回転または拡大する設定になっています。</translation>
    </message>
    <message>
        <source>Set basis, mount and workspace back in Haply Hub.</source>
        <translation>Haply Hubでbasis、mount、workspaceを元に戻してください。</translation>
    </message>
    <message>
        <source>Haply&apos;s service at %1 is not on this machine.</source>
        <translation>%1 のHaplyのサービスは、このコンピューターのものではありません。</translation>
    </message>
    <message>
        <source>Set HANDPIECE_HAPLY_REMOTE=1 if forces may cross the network.</source>
        <translation>力をネットワーク越しに送ってよい場合は、HANDPIECE_HAPLY_REMOTE=1 を設定してください。</translation>
    </message>
    <message>
        <source>A device that pushes was to be used as an input.</source>
        <translation>力を出すデバイスが入力専用として使われようとしました。</translation>
    </message>
    <message>
        <source>The device %1 does not tell where it is.</source>
        <translation>デバイス %1 が位置を知らせません。</translation>
    </message>
    <message>
        <source>Switch it off and on, and close other programs that use it.</source>
        <translation>電源を入れ直し、それを使う他のプログラムを閉じてください。</translation>
    </message>
    <message>
        <source>The device %1 cannot be calibrated before it is connected.</source>
        <translation>デバイス %1 は接続する前に校正できません。</translation>
    </message>
    <message>
        <source>Connect it first.</source>
        <translation>先に接続してください。</translation>
    </message>
    <message>
        <source>The pedal&apos;s settings cannot be used.</source>
        <translation>ペダルの設定が使えません。</translation>
    </message>
    <message>
        <source>Give an axis from 0 and a dead travel of 0 to 0.4.</source>
        <translation>軸は0以上、遊びは0から0.4までにしてください。</translation>
    </message>
    <message>
        <source>A scale of %1 is finer than the one the device was opened with, %2.</source>
        <translation>倍率 %1 は、デバイスを開いたときの倍率 %2 より細かくなっています。</translation>
    </message>
    <message>
        <source>Connect the device again with that scale.</source>
        <translation>その倍率でデバイスを接続し直してください。</translation>
    </message>
    <message>
        <source>SDL, which reads gamepads and pedals, does not start: %1.</source>
        <translation>ゲームパッドとペダルを読むSDLが起動しません：%1。</translation>
    </message>
    <message>
        <source>Install libsdl2-2.0-0 again.</source>
        <translation>libsdl2-2.0-0 を入れ直してください。</translation>
    </message>
    <message>
        <source>The device cannot run at %1 Hz.</source>
        <translation>デバイスは %1 Hz では動きません。</translation>
    </message>
    <message>
        <source>Ask for 50 to 8000 Hz.</source>
        <translation>50から8000 Hzまでにしてください。</translation>
    </message>
    <message>
        <source>This account may not use the SpaceMouse&apos;s service: %1.</source>
        <translation>このアカウントはSpaceMouseのサービスを使えません：%1。</translation>
    </message>
    <message>
        <source>Allow it to use spacenavd&apos;s socket.</source>
        <translation>spacenavdのソケットを使えるように許可してください。</translation>
    </message>
    <message>
        <source>This is no address of a service: %1.</source>
        <translation>これはサービスのアドレスではありません：%1。</translation>
    </message>
    <message>
        <source>Write it as ws://localhost:10001.</source>
        <translation>ws://localhost:10001 のように書いてください。</translation>
    </message>
    <message>
        <source>The service at %1 does not answer.</source>
        <translation>%1 のサービスが応答しません。</translation>
    </message>
    <message>
        <source>Start the device&apos;s service again.</source>
        <translation>デバイスのサービスを起動し直してください。</translation>
    </message>
    <message>
        <source>Another program answers at %1, not the device&apos;s service.</source>
        <translation>%1 で応答したのはデバイスのサービスではなく、別のプログラムです。</translation>
    </message>
    <message>
        <source>Check which port the service uses.</source>
        <translation>サービスが使うポートを確かめてください。</translation>
    </message>
    <message>
        <source>Mend it here, or with: handpiece mesh repair FILE MENDED.stl</source>
        <translation>ここで修復するか、次を実行してください：handpiece mesh repair FILE MENDED.stl</translation>
    </message>
    <message>
        <source>This is the marking desk of %1.</source>
        <translation>これは %1 の採点机です。</translation>
    </message>
    <message>
        <source>Mark under another name.</source>
        <translation>別の名前で採点してください。</translation>
    </message>
    <message>
        <source>This marking desk was begun for another exercise, %1.</source>
        <translation>この採点机は別の課題 %1 で始められました。</translation>
    </message>
    <message>
        <source>Choose that exercise, or mark under another name.</source>
        <translation>その課題を選ぶか、別の名前で採点してください。</translation>
    </message>
    <message>
        <source>This desk marks blind by another rubric, %1.</source>
        <translation>この採点机は別のルーブリック %1 でブラインド採点をしています。</translation>
    </message>
    <message>
        <source>Choose that rubric, or mark under another name.</source>
        <translation>そのルーブリックを選ぶか、別の名前で採点してください。</translation>
    </message>
    <message>
        <source>This desk marks blind.</source>
        <translation>この採点机はブラインド採点です。</translation>
    </message>
    <message>
        <source>Tick &quot;Mark blind&quot; to go on, or mark under another name.</source>
        <translation>「ブラインド採点」に印を付けて続けるか、別の名前で採点してください。</translation>
    </message>
    <message>
        <source>This desk shows the machine&apos;s score.</source>
        <translation>この採点机は機械の得点を表示しています。</translation>
    </message>
    <message>
        <source>Untick &quot;Mark blind&quot; to go on, or mark under another name.</source>
        <translation>「ブラインド採点」の印を外して続けるか、別の名前で採点してください。</translation>
    </message>
    <message>
        <source>Somebody else marks at this desk; this change was not kept.</source>
        <translation>別の場所でこの採点机が使われています。この変更は保存されませんでした。</translation>
    </message>
    <message>
        <source>Begin again: what stands there now is taken up.</source>
        <translation>もう一度始めてください。今の内容から続けられます。</translation>
    </message>
    <message>
        <source>This marking desk cannot be read. Technical detail: %1</source>
        <translation>この採点机は読めません。技術的な詳細：%1</translation>
    </message>
    <message>
        <source>Bring its file back from a copy, or mark under another name.</source>
        <translation>控えからファイルを戻すか、別の名前で採点してください。</translation>
    </message>
    <message>
        <source>This marking desk was made by a newer program.</source>
        <translation>この採点机は新しいプログラムで作られました。</translation>
    </message>
    <message>
        <source>Use the newer program.</source>
        <translation>新しいプログラムを使ってください。</translation>
    </message>
    <message>
        <source>Nobody can mark under this name.</source>
        <translation>この名前では採点できません。</translation>
    </message>
    <message>
        <source>Give a name or a code without / \ and quotes; &quot;machine&quot; is taken.</source>
        <translation>/ \ と引用符を含まない名前かコードを入れてください。「machine」は使えません。</translation>
    </message>
    <message>
        <source>There is no such folder.</source>
        <translation>そのフォルダーはありません。</translation>
    </message>
    <message>
        <source>Choose the folder with the returned work.</source>
        <translation>提出物のフォルダーを選んでください。</translation>
    </message>
    <message>
        <source>This exercise has no rubric.</source>
        <translation>この課題にはルーブリックがありません。</translation>
    </message>
    <message>
        <source>Choose a rubric.</source>
        <translation>ルーブリックを選んでください。</translation>
    </message>
    <message>
        <source>Your results were kept by a newer Handpiece (version %1, this one knows %2).</source>
        <translation>成績は新しい Handpiece で保存されています（バージョン %1、このプログラムは %2 まで）。</translation>
    </message>
    <message>
        <source>Use that one. Nothing is lost.</source>
        <translation>新しいほうを使ってください。何も失われていません。</translation>
    </message>
    <message>
        <source>Another program is writing your results.</source>
        <translation>別のプログラムが成績を書き込んでいます。</translation>
    </message>
    <message>
        <source>Close the other one, or try again.</source>
        <translation>そのプログラムを閉じるか、もう一度試してください。</translation>
    </message>
    <message>
        <source>The file of your results cannot be read. Technical detail: %1</source>
        <translation>成績のファイルを読み込めません。技術的な詳細：%1</translation>
    </message>
    <message>
        <source>Move the file away: a new one is made.</source>
        <translation>ファイルを別の場所に移してください。新しいファイルが作られます。</translation>
    </message>
    <message>
        <source>This exercise is worked in voxels of %1 um: a score never hangs on one&apos;s settings.</source>
        <translation>この課題のボクセルは %1 um に決まっています。得点が各自の設定で変わらないようにするためです。</translation>
    </message>
    <message>
        <source>Open another tooth to choose the size.</source>
        <translation>大きさを選ぶには、別の歯を開いてください。</translation>
    </message>
    <message>
        <source>&quot;%1&quot; cannot be read.</source>
        <translation>「%1」を読み取れない。</translation>
    </message>
    <message>
        <source>Write it as in: %2</source>
        <translation>次のように書く：%2</translation>
    </message>
    <message>
        <source>A weight is a number above 0.</source>
        <translation>配点は 0 より大きい数にする。</translation>
    </message>
    <message>
        <source>Leave it empty for a criterion that is shown and not graded.</source>
        <translation>表示するだけで採点しない項目では空にする。</translation>
    </message>
    <message>
        <source>The preparation holds nothing of the tooth.</source>
        <translation>形成の中に歯がない。</translation>
    </message>
    <message>
        <source>Give other numbers, or set the landmarks anew.</source>
        <translation>別の数値にするか、ランドマークを設定し直す。</translation>
    </message>
    <message>
        <source>The tooth has no surface as a whole.</source>
        <translation>歯全体の表面がない。</translation>
    </message>
    <message>
        <source>Take another tooth, or give its case the whole tooth as one closed surface.</source>
        <translation>別の歯を使うか、症例に歯全体を一つの閉じた表面として加える。</translation>
    </message>
    <message>
        <source>The preparation lies outside the tooth.</source>
        <translation>形成が歯の外にある。</translation>
    </message>
    <message>
        <source>Give other sizes.</source>
        <translation>別の寸法にする。</translation>
    </message>
    <message>
        <source>The tooth has no fissures as landmarks.</source>
        <translation>歯に裂溝のランドマークがない。</translation>
    </message>
    <message>
        <source>Find or set them with the tooth open in the window (Ctrl+J), and save the case.</source>
        <translation>歯をウィンドウに開いて検出または設定し（Ctrl+J）、症例を保存する。</translation>
    </message>
    <message>
        <source>The tooth has no contacts as landmarks.</source>
        <translation>歯に接触点のランドマークがない。</translation>
    </message>
    <message>
        <source>The tooth has no root canal orifices as landmarks.</source>
        <translation>歯に根管口のランドマークがない。</translation>
    </message>
    <message>
        <source>The tooth has no cemento-enamel junction as a landmark.</source>
        <translation>歯にセメント・エナメル境のランドマークがない。</translation>
    </message>
    <message>
        <source>Find or set it with the tooth open in the window (Ctrl+J), and save the case.</source>
        <translation>歯をウィンドウに開いて検出または設定し（Ctrl+J）、症例を保存する。</translation>
    </message>
    <message>
        <source>The tooth has no mesial contact.</source>
        <translation>歯に近心の接触点がない。</translation>
    </message>
    <message>
        <source>Set it with the tooth open in the window (Ctrl+Shift+J), or ask for the distal side.</source>
        <translation>歯をウィンドウに開いて設定する（Ctrl+Shift+J）か、遠心側を選ぶ。</translation>
    </message>
    <message>
        <source>The tooth has no distal contact.</source>
        <translation>歯に遠心の接触点がない。</translation>
    </message>
    <message>
        <source>Set it with the tooth open in the window (Ctrl+Shift+J), or ask for the mesial side.</source>
        <translation>歯をウィンドウに開いて設定する（Ctrl+Shift+J）か、近心側を選ぶ。</translation>
    </message>
    <message>
        <source>The case does not say which side is buccal.</source>
        <translation>どちらが頬側か症例に書かれていない。</translation>
    </message>
    <message>
        <source>Say it in the case: buccal = &quot;+y&quot; or &quot;-y&quot;.</source>
        <translation>症例に buccal = &quot;+y&quot; または &quot;-y&quot; と書く。</translation>
    </message>
    <message>
        <source>The figure is wider than long.</source>
        <translation>図形の幅が長さより大きい。</translation>
    </message>
    <message>
        <source>Give a greater length.</source>
        <translation>長さを大きくする。</translation>
    </message>
    <message>
        <source>The island is as wide as the figure.</source>
        <translation>中央の島が図形と同じ大きさになっている。</translation>
    </message>
    <message>
        <source>Make it less.</source>
        <translation>小さくする。</translation>
    </message>
    <message>
        <source>No fissure lies on the occlusal surface.</source>
        <translation>咬合面に裂溝がない。</translation>
    </message>
    <message>
        <source>Set them with the tooth open in the window (Ctrl+Shift+J).</source>
        <translation>歯をウィンドウに開いて設定する（Ctrl+Shift+J）。</translation>
    </message>
    <message>
        <source>There is no room along the fissures.</source>
        <translation>裂溝に沿った余地がない。</translation>
    </message>
    <message>
        <source>Give a thinner ridge, or a lesser width or depth.</source>
        <translation>残す隆線を薄くするか、幅か深さを小さくする。</translation>
    </message>
    <message>
        <source>The contact does not lie on the tooth.</source>
        <translation>接触点が歯の上にない。</translation>
    </message>
    <message>
        <source>Set it with the tooth open in the window (Ctrl+Shift+J).</source>
        <translation>歯をウィンドウに開いて設定する（Ctrl+Shift+J）。</translation>
    </message>
    <message>
        <source>The cemento-enamel junction does not reach the buccal side.</source>
        <translation>セメント・エナメル境が頬側に届いていない。</translation>
    </message>
    <message>
        <source>Set it anew with the tooth open in the window (Ctrl+Shift+J).</source>
        <translation>歯をウィンドウに開いて設定し直す（Ctrl+Shift+J）。</translation>
    </message>
    <message>
        <source>The cemento-enamel junction rises so far beside the cavity that no height is left.</source>
        <translation>セメント・エナメル境が窩洞の脇で高くなりすぎて、窩洞の高さが残らない。</translation>
    </message>
    <message>
        <source>Make the cavity narrower or higher.</source>
        <translation>窩洞を狭くするか、高くする。</translation>
    </message>
    <message>
        <source>The margin does not lie on the tooth.</source>
        <translation>マージンが歯の上にない。</translation>
    </message>
    <message>
        <source>Give another height over the cemento-enamel junction.</source>
        <translation>セメント・エナメル境からの高さを変える。</translation>
    </message>
    <message>
        <source>The tooth has no carious tissue.</source>
        <translation>歯にう蝕組織がない。</translation>
    </message>
    <message>
        <source>Take a tooth with a lesion, or another preparation.</source>
        <translation>病変のある歯か、別の形成を選ぶ。</translation>
    </message>
    <message>
        <source>The recordings of this work are no longer kept.</source>
        <translation>この作業の記録はもう残っていません。</translation>
    </message>
    <message>
        <source>Without them there is no tooth to hand in: hand in soon after you finish.</source>
        <translation>記録がないと提出する歯がありません。完了したら早めに提出してください。</translation>
    </message>
    <message>
        <source>This work has no score, and so cannot be given back.</source>
        <translation>この提出物には得点がないため、返却できません。</translation>
    </message>
    <message>
        <source>Score it: by that its student&apos;s program finds the work that the marks are of.</source>
        <translation>採点してください。受講者のプログラムは、それによってどの作業の評価かを見つけます。</translation>
    </message>
    <message>
        <source>These are no marks of a teacher. Technical detail: %1</source>
        <translation>これは先生の評価のファイルではありません。技術的な詳細：%1</translation>
    </message>
    <message>
        <source>Ask your teacher for the file once more.</source>
        <translation>先生にもう一度ファイルをもらってください。</translation>
    </message>
    <message>
        <source>These marks were written by a newer program.</source>
        <translation>この評価は新しいプログラムで書かれています。</translation>
    </message>
    <message>
        <source>These marks are of no work that was finished here (exercise %1).</source>
        <translation>この評価に当たる作業は、ここでは完了していません（課題 %1）。</translation>
    </message>
    <message>
        <source>Open them where you finished that work, under your own account.</source>
        <translation>その作業を完了したコンピューターで、自分のアカウントで開いてください。</translation>
    </message>
    <message>
        <source>Another work is the same, byte for byte.</source>
        <translation>ほかの作品とまったく同じ内容です。</translation>
    </message>
    <message>
        <source>Ask whose it is.</source>
        <translation>だれの作品か確かめてください。</translation>
    </message>
    <message>
        <source>This is work on another tooth than the exercise&apos;s.</source>
        <translation>この課題とは別の歯の作品です。</translation>
    </message>
    <message>
        <source>Choose the exercise that it was done on.</source>
        <translation>作業した課題を選んでください。</translation>
    </message>
    <message>
        <source>This is a result of another exercise.</source>
        <translation>別の課題の結果です。</translation>
    </message>
    <message>
        <source>This is a result by another rubric: %1, version %2.</source>
        <translation>別のルーブリックによる結果です：%1、版 %2。</translation>
    </message>
    <message>
        <source>This result has other criteria than its rubric.</source>
        <translation>この結果の項目はルーブリックと一致しません。</translation>
    </message>
    <message>
        <source>This was cut in voxels of %1 micrometres; the exercise has %2.</source>
        <translation>%1 µm のボクセルで削られています。課題は %2 µm です。</translation>
    </message>
    <message>
        <source>Work on it as the exercise has it.</source>
        <translation>課題のとおりに作業してください。</translation>
    </message>
    <message>
        <source>This work is no longer in the folder, or was changed.</source>
        <translation>この作品はフォルダーにないか、変更されています。</translation>
    </message>
    <message>
        <source>Put it back, or score again.</source>
        <translation>元に戻すか、再採点してください。</translation>
    </message>
    <message>
        <source>This is no recording.</source>
        <translation>これは記録ではありません。</translation>
    </message>
    <message>
        <source>Choose a session.h5: one recording, from its beginning.</source>
        <translation>session.h5 を選んでください：初めからの一つの記録です。</translation>
    </message>
    <message>
        <source>Cut again, this recording does not come to the same tooth.</source>
        <translation>切削し直しても、この記録は同じ歯になりません。</translation>
    </message>
    <message>
        <source>Record one from the whole tooth to its end, with this program.</source>
        <translation>このプログラムで、未切削の歯から終わりまで記録してください。</translation>
    </message>
    <message>
        <source>The exercise has no tooth yet.</source>
        <translation>課題にまだ歯がありません。</translation>
    </message>
    <message>
        <source>Choose its tooth first, on the page Tooth.</source>
        <translation>先に「歯」のページで歯を選んでください。</translation>
    </message>
    <message>
        <source>The tooth or its voxel was changed while your work was cut again.</source>
        <translation>作業を切削し直している間に、歯かボクセルが変わりました。</translation>
    </message>
    <message>
        <source>Choose your work again.</source>
        <translation>作業をもう一度選んでください。</translation>
    </message>
    <message>
        <source>This was handed in for another exercise: %1.</source>
        <translation>これは別の課題の提出物です：%1。</translation>
    </message>
    <message>
        <source>Choose that exercise, or take the work out of the folder.</source>
        <translation>その課題を選ぶか、作品をフォルダーから出してください。</translation>
    </message>
    <message>
        <source>It cannot be scored; why is told once your marks are in.</source>
        <translation>採点できません。理由は評価の確定後に示します。</translation>
    </message>
    <message>
        <source>It may go in without marks.</source>
        <translation>評価なしで確定できます。</translation>
    </message>
    <message>
        <source>The margin of a capped cusp would lie under the cemento-enamel junction.</source>
        <translation>被覆咬頭のマージンがセメント・エナメル境より下になります。</translation>
    </message>
    <message>
        <source>Take less off the cusp, or make the shoulder lower.</source>
        <translation>咬頭の削除量またはショルダーの高さを減らしてください。</translation>
    </message>
    <message>
        <source>The recorded work of the exercise is not there.</source>
        <translation>課題の記録された形成がありません。</translation>
    </message>
    <message>
        <source>Take the work in the editor, or open the exercise's own folder or file.</source>
        <translation>編集画面で形成を取り込むか、課題自身のフォルダーまたはファイルを開いてください。</translation>
    </message>
    <message>
        <source>Nothing is painted.</source>
        <translation>何も塗られていません。</translation>
    </message>
    <message>
        <source>Paint on the tooth with the left button.</source>
        <translation>左ボタンで歯の上を塗ってください。</translation>
    </message>
    <message>
        <source>Choose work on this tooth, or begin a new exercise.</source>
        <translation>この歯の形成を選ぶか、新しい課題を作ってください。</translation>
    </message>
    <message>
        <source>Nothing was cut in this work.</source>
        <translation>この作業では何も切削されていません。</translation>
    </message>
    <message>
        <source>Choose work in which the target was cut.</source>
        <translation>目標を切削した作業を選んでください。</translation>
    </message>
    <message>
        <source>This file is neither a session nor an attempt.</source>
        <translation>このファイルは記録でも保存した作業でもありません。</translation>
    </message>
    <message>
        <source>Choose a saved attempt, or a session (.h5).</source>
        <translation>保存した作業か記録 (.h5) を選んでください。</translation>
    </message>
    <message>
        <source>By this exercise&apos;s rubric your work gets %1 of %2 points and does not pass.</source>
        <translation>この課題のルーブリックでは、この作業は %2 点中 %1 点で、不合格です。</translation>
    </message>
    <message>
        <source>It comes along all the same. If it is of another exercise on this tooth, remove it.</source>
        <translation>それでも付属します。同じ歯の別の課題の記録であれば、取り除いてください。</translation>
    </message>
    <message>
        <source>The service that holds this station&apos;s exams does not answer.</source>
        <translation>この端末の試験サービスが応答しません。</translation>
    </message>
    <message>
        <source>Call the invigilator: it is started on this computer by its own user.</source>
        <translation>監督者を呼んでください。このコンピューターで、専用のユーザーが起動します。</translation>
    </message>
    <message>
        <source>The school&apos;s part of the program is not installed, or has ended (handpiece-school).</source>
        <translation>学校用のプログラム (handpiece-school) がインストールされていないか、終了しました。</translation>
    </message>
    <message>
        <source>Call the invigilator.</source>
        <translation>監督者を呼んでください。</translation>
    </message>
    <message>
        <source>Another window of this program holds unsaved work.</source>
        <translation>このプログラムの別のウィンドウに、保存していない作業があります。</translation>
    </message>
    <message>
        <source>Save or close it, then begin the exam.</source>
        <translation>保存するか閉じてから、試験を始めてください。</translation>
    </message>
    <message>
        <source>This exam begins %1; at this station it is %2.</source>
        <translation>この試験の開始は %1 です。この端末の時刻は %2 です。</translation>
    </message>
    <message>
        <source>Wait, or let this station&apos;s clock be put right.</source>
        <translation>待つか、端末の時計を直してもらってください。</translation>
    </message>
    <message>
        <source>This exam could be begun until %1; at this station it is %2.</source>
        <translation>この試験を始められたのは %1 までです。この端末の時刻は %2 です。</translation>
    </message>
    <message>
        <source>Call the invigilator: a teacher can give it a new time, or this station&apos;s clock is wrong.</source>
        <translation>監督者を呼んでください。教員が時間を改めるか、端末の時計を直します。</translation>
    </message>
    <message>
        <source>No exam at this station knows this candidate&apos;s code.</source>
        <translation>この端末の試験に、この受験者コードはありません。</translation>
    </message>
    <message>
        <source>Type it as it stands on the slip. Who came later needs the exam to be fetched again.</source>
        <translation>受験票のとおりに入力してください。後から加わった人は、試験を取得し直す必要があります。</translation>
    </message>
    <message>
        <source>Nobody who may confirm a candidate&apos;s identity at this exam has these codes.</source>
        <translation>この試験で本人を確認できる監督者のコードではありません。</translation>
    </message>
    <message>
        <source>An invigilator of this exam types their own code, and a code that stands beside this candidate on their sheet.</source>
        <translation>この試験の監督者が、自分のコードと、一覧表でこの受験者の横にあるコードを入力してください。</translation>
    </message>
    <message>
        <source>This confirmation code has been used.</source>
        <translation>この確認コードは使用済みです。</translation>
    </message>
    <message>
        <source>Type the next one that stands beside this candidate on the sheet.</source>
        <translation>一覧表でこの受験者の横にある次のコードを入力してください。</translation>
    </message>
    <message>
        <source>This exam&apos;s exercise is sealed still.</source>
        <translation>この試験の課題はまだ封印されています。</translation>
    </message>
    <message>
        <source>It opens by itself within a minute where the school&apos;s server can be reached. Without it an invigilator types the opening code of their sheet below.</source>
        <translation>学校のサーバーに接続できれば、1 分以内に自動で開きます。接続できない場合は、監督者が一覧表の開封コードを下に入力してください。</translation>
    </message>
    <message>
        <source>This code does not open the exam.</source>
        <translation>このコードでは試験を開けません。</translation>
    </message>
    <message>
        <source>An invigilator types the opening code of this exam&apos;s sheet.</source>
        <translation>監督者が、この試験の一覧表にある開封コードを入力してください。</translation>
    </message>
    <message>
        <source>This exam was begun in another account of this computer.</source>
        <translation>この試験は、このコンピューターの別のアカウントで始められています。</translation>
    </message>
    <message>
        <source>Go on in that account, or call the invigilator.</source>
        <translation>そのアカウントで続けるか、監督者を呼んでください。</translation>
    </message>
    <message>
        <source>Too many wrong confirmation codes.</source>
        <translation>確認コードの誤りが多すぎます。</translation>
    </message>
    <message>
        <source>Wait %1 s, then try again.</source>
        <translation>%1 秒待ってから、もう一度入力してください。</translation>
    </message>
    <message>
        <source>Somebody is at an exam at this station.</source>
        <translation>この端末では、ほかの人が受験中です。</translation>
    </message>
    <message>
        <source>Hand that work over first, or let an invigilator give it up.</source>
        <translation>先にその作業を提出するか、監督者に中止してもらってください。</translation>
    </message>
    <message>
        <source>Nobody is at this exam at this station.</source>
        <translation>この端末では、この試験は行われていません。</translation>
    </message>
    <message>
        <source>This exam is not as the school signed it.</source>
        <translation>この試験は、学校が署名した内容と異なります。</translation>
    </message>
    <message>
        <source>Call the invigilator: it has to be fetched again from the school&apos;s server.</source>
        <translation>監督者を呼んでください。学校のサーバーから取得し直す必要があります。</translation>
    </message>
    <message>
        <source>This exam was signed by another than this station&apos;s school.</source>
        <translation>この試験は、この端末の学校以外が署名しています。</translation>
    </message>
    <message>
        <source>This exam names somebody twice: %2.</source>
        <translation>この試験には同じ人が 2 回あります：%2。</translation>
    </message>
    <message>
        <source>Call the invigilator: a teacher mends the exam and signs it again.</source>
        <translation>監督者を呼んでください。教員が試験を直し、署名し直します。</translation>
    </message>
    <message>
        <source>What the station says of the exam cannot be read.</source>
        <translation>端末の試験の情報を読み取れません。</translation>
    </message>
    <message>
        <source>Call the invigilator: it has to be fetched again, by programs of one version.</source>
        <translation>監督者を呼んでください。同じ版のプログラムで取得し直す必要があります。</translation>
    </message>
    <message>
        <source>This exam&apos;s rubric is newer than this program.</source>
        <translation>この試験のルーブリックは、このプログラムより新しいものです。</translation>
    </message>
    <message>
        <source>Call the invigilator: this station needs the newer program.</source>
        <translation>監督者を呼んでください。この端末には新しいプログラムが必要です。</translation>
    </message>
    <message>
        <source>This exam was made for another version of the simulation.</source>
        <translation>この試験は、別の版のシミュレーション用に作られています。</translation>
    </message>
    <message>
        <source>Call the invigilator: this station needs the program that the school&apos;s server has.</source>
        <translation>監督者を呼んでください。学校のサーバーと同じプログラムが必要です。</translation>
    </message>
    <message>
        <source>This exam was made by a newer program.</source>
        <translation>この試験は新しいプログラムで作られています。</translation>
    </message>
    <message>
        <source>An exam of a newer version is here already.</source>
        <translation>新しい版の試験がすでにあります。</translation>
    </message>
    <message>
        <source>Nothing is to be done: the newer one holds.</source>
        <translation>何もする必要はありません。新しい方が有効です。</translation>
    </message>
    <message>
        <source>The exam&apos;s exercise is not the one that was signed.</source>
        <translation>試験の課題が、署名されたものと異なります。</translation>
    </message>
    <message>
        <source>What this station noted of exams was changed.</source>
        <translation>この端末の試験の記録が変更されています。</translation>
    </message>
    <message>
        <source>Call the invigilator, and tell the school&apos;s administrator.</source>
        <translation>監督者を呼び、学校の管理者に知らせてください。</translation>
    </message>
    <message>
        <source>Another service holds the exams of this station.</source>
        <translation>この端末の試験は、別のサービスが扱っています。</translation>
    </message>
    <message>
        <source>Call the invigilator: one is enough.</source>
        <translation>監督者を呼んでください。サービスは 1 つで足ります。</translation>
    </message>
</context>
<context>
    <name>Pulp</name>
    <message>
        <source>%1 mm or more</source>
        <translation>%1 mm 以上</translation>
    </message>
    <message>
        <source>Under %1 mm</source>
        <translation>%1 mm 未満</translation>
    </message>
</context>
<context>
    <name>QShortcut</name>
    <message>
        <source>Backspace</source>
        <translation>Backspace</translation>
    </message>
</context>
<context>
    <name>Tissue</name>
    <message>
        <source>None</source>
        <translation>なし</translation>
    </message>
    <message>
        <source>Enamel</source>
        <translation>エナメル質</translation>
    </message>
    <message>
        <source>Dentine</source>
        <translation>象牙質</translation>
    </message>
    <message>
        <source>Pulp</source>
        <translation>歯髄</translation>
    </message>
    <message>
        <source>Caries</source>
        <translation>う蝕</translation>
    </message>
    <message>
        <source>Cementum</source>
        <translation>セメント質</translation>
    </message>
    <message>
        <source>Gingiva</source>
        <translation>歯肉</translation>
    </message>
    <message>
        <source>Bone</source>
        <translation>骨</translation>
    </message>
    <message>
        <source>Adjacent tooth</source>
        <translation>隣在歯</translation>
    </message>
    <message>
        <source>Filling</source>
        <translation>修復物</translation>
    </message>
    <message>
        <source>Demineralised enamel</source>
        <translation>脱灰エナメル質</translation>
    </message>
    <message>
        <source>Soft carious dentine</source>
        <translation>軟化う蝕象牙質</translation>
    </message>
    <message>
        <source>Soft to leathery carious dentine</source>
        <translation>軟らかい～革状のう蝕象牙質</translation>
    </message>
    <message>
        <source>Leathery carious dentine</source>
        <translation>革状のう蝕象牙質</translation>
    </message>
    <message>
        <source>Leathery to firm carious dentine</source>
        <translation>革状～やや硬いう蝕象牙質</translation>
    </message>
    <message>
        <source>Firm carious dentine</source>
        <translation>やや硬いう蝕象牙質</translation>
    </message>
    <message>
        <source>Firm to hard carious dentine</source>
        <translation>やや硬い～硬いう蝕象牙質</translation>
    </message>
    <message>
        <source>Stained enamel</source>
        <translation>着色エナメル質</translation>
    </message>
    <message>
        <source>Calculus</source>
        <translation>歯石</translation>
    </message>
</context>
<context>
    <name>TissuePage</name>
    <message>
        <source>Look</source>
        <translation>見る</translation>
    </message>
    <message>
        <source>Click or drag in a slice: the other two follow</source>
        <translation>スライス上でクリックまたはドラッグすると、ほかの 2 つも追従します</translation>
    </message>
    <message>
        <source>This tooth</source>
        <translation>この歯</translation>
    </message>
    <message>
        <source>Click in the crown or a root of the tooth that is wanted; the rest is left out</source>
        <translation>使いたい歯の歯冠か歯根をクリックします。ほかは除かれます</translation>
    </message>
    <message>
        <source>Brush</source>
        <translation>ブラシ</translation>
    </message>
    <message>
        <source>Drag over what the program took for something else</source>
        <translation>プログラムが取り違えた場所をドラッグで塗ります</translation>
    </message>
    <message>
        <source>Cut off</source>
        <translation>切り離す</translation>
    </message>
    <message>
        <source>Draw a line between the tooth and what it touches: a plane through it parts the two</source>
        <translation>歯と、歯に接しているものとの間に線を引くと、その線を通る平面で切り離します</translation>
    </message>
    <message>
        <source>Lesion</source>
        <translation>病変</translation>
    </message>
    <message>
        <source>Click where caries shall be that the patient does not have. The case says that it was authored</source>
        <translation>患者にはないう蝕を置く場所をクリックします。症例には作成された病変と記されます</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::BlockView</name>
    <message>
        <source>The block and the bur</source>
        <translation>ブロックとバー</translation>
    </message>
    <message>
        <source>The block from the side, the bur where it rests, and the force on the hand as a line</source>
        <translation>横から見たブロックとバーの位置、手にかかる力を線で示します</translation>
    </message>
    <message>
        <source>touching</source>
        <translation>接触中</translation>
    </message>
    <message>
        <source>in the air</source>
        <translation>空中</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::BurModel</name>
    <message>
        <source>%1 mm</source>
        <translation>%1 mm</translation>
    </message>
    <message>
        <source>Own bur</source>
        <translation>自作のバー</translation>
    </message>
    <message>
        <source>US %1 · %2</source>
        <translation>US %1 · %2</translation>
    </message>
    <message>
        <source>%1, %2, diameter %3</source>
        <translation>%1、%2、直径 %3</translation>
    </message>
    <message>
        <source>%1, %2</source>
        <translation>%1、%2</translation>
    </message>
    <message>
        <source>Diameter %1, length %2</source>
        <translation>直径 %1、長さ %2</translation>
    </message>
    <message>
        <source>US number %1</source>
        <translation>US 番号 %1</translation>
    </message>
    <message>
        <source>ISO number %1</source>
        <translation>ISO 番号 %1</translation>
    </message>
    <message>
        <source>Ring: %1</source>
        <translation>色リング：%1</translation>
    </message>
    <message>
        <source>Not part of this exercise.</source>
        <translation>この課題では使えません。</translation>
    </message>
    <message>
        <source>Round %1</source>
        <translation>ラウンド %1</translation>
    </message>
    <message>
        <source>Steel round %1</source>
        <translation>スチールラウンド %1</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ChoosePage</name>
    <message>
        <source>size of a voxel not told</source>
        <translation>ボクセルの大きさ：記載なし</translation>
    </message>
    <message>
        <source>voxels of %1 mm</source>
        <translation>ボクセル %1 mm</translation>
    </message>
    <message>
        <source>voxels of %1 × %2 × %3 mm</source>
        <translation>ボクセル %1 × %2 × %3 mm</translation>
    </message>
    <message>
        <source>Drop a folder of slices, a ZIP or a file here</source>
        <translation>スライスのフォルダー、ZIP、ファイルをここにドロップ</translation>
    </message>
    <message>
        <source>DICOM, slices as TIFF, PNG, JPEG or BMP, NRRD, NIfTI, MetaImage, raw with a description. Names of patients stay in the scan: nothing of them goes into the case.</source>
        <translation>DICOM、TIFF・PNG・JPEG・BMP のスライス、NRRD、NIfTI、MetaImage、説明付きの生データを読み込めます。患者の名前はスキャンの中にとどまり、症例には入りません。</translation>
    </message>
    <message>
        <source>Folder...</source>
        <translation>フォルダー...</translation>
    </message>
    <message>
        <source>Choose a folder of slices</source>
        <translation>スライスのフォルダーを選びます</translation>
    </message>
    <message>
        <source>File...</source>
        <translation>ファイル...</translation>
    </message>
    <message>
        <source>Choose a file or a ZIP</source>
        <translation>ファイルまたは ZIP を選びます</translation>
    </message>
    <message>
        <source>What was found</source>
        <translation>見つかったもの</translation>
    </message>
    <message>
        <source>Choose the scan of the tooth</source>
        <translation>歯のスキャンを選びます</translation>
    </message>
    <message>
        <source>The middle slice</source>
        <translation>中央のスライス</translation>
    </message>
    <message>
        <source>How large is a voxel?</source>
        <translation>ボクセルの大きさ</translation>
    </message>
    <message>
        <source> mm</source>
        <translation> mm</translation>
    </message>
    <message>
        <source>not said yet</source>
        <translation>未入力</translation>
    </message>
    <message>
        <source>Between pixels of a slice</source>
        <translation>スライス内の画素の間隔</translation>
    </message>
    <message>
        <source>Between slices</source>
        <translation>スライスの間隔</translation>
    </message>
    <message>
        <source>Estimate by a mean molar</source>
        <translation>平均的な大臼歯から見積もる</translation>
    </message>
    <message>
        <source>The size at which the tooth is as long as a mean first molar, 21 mm</source>
        <translation>歯の長さが平均的な第一大臼歯と同じ 21 mm になる大きさ</translation>
    </message>
    <message>
        <source>Read the slices from the other end</source>
        <translation>スライスを反対側の端から読む</translation>
    </message>
    <message>
        <source>The slices are numbered from the other end</source>
        <translation>スライスの番号が反対側の端から付いている</translation>
    </message>
    <message>
        <source>For a tooth that came out as its mirror image: where the files do not tell, nobody can see it in the numbers</source>
        <translation>歯が鏡像になったとき用。ファイルに向きの記載がないと、数値からは分からない</translation>
    </message>
    <message>
        <source>&lt;ol&gt;&lt;li&gt;Choose the scan.&lt;/li&gt;&lt;li&gt;See which tissues were found in it; correct by hand where the program is wrong.&lt;/li&gt;&lt;li&gt;Say how fine the surfaces shall be.&lt;/li&gt;&lt;li&gt;Say which way is up, and give the case a name.&lt;/li&gt;&lt;li&gt;Read how good it is, save it, try it.&lt;/li&gt;&lt;/ol&gt;</source>
        <translation>&lt;ol&gt;&lt;li&gt;スキャンを選びます。&lt;/li&gt;&lt;li&gt;見つかった組織を確かめ、誤りがあれば手で直します。&lt;/li&gt;&lt;li&gt;表面の細かさを決めます。&lt;/li&gt;&lt;li&gt;上下の向きを確かめ、症例に名前を付けます。&lt;/li&gt;&lt;li&gt;出来ばえを読み、保存して、試します。&lt;/li&gt;&lt;/ol&gt;</translation>
    </message>
    <message>
        <source>A folder of slices</source>
        <translation>スライスのフォルダー</translation>
    </message>
    <message>
        <source>A scan</source>
        <translation>スキャン</translation>
    </message>
    <message>
        <source>Scans (*.nrrd *.nhdr *.nii *.nii.gz *.mha *.mhd *.zip *.dcm *.tif *.tiff *.toml DICOMDIR);;All files (*)</source>
        <translation>スキャン (*.nrrd *.nhdr *.nii *.nii.gz *.mha *.mhd *.zip *.dcm *.tif *.tiff *.toml DICOMDIR);;すべてのファイル (*)</translation>
    </message>
    <message>
        <source>Choose a scan first</source>
        <translation>まずスキャンを選んでください</translation>
    </message>
    <message>
        <source>Nothing was found yet</source>
        <translation>まだ何も見つかっていません</translation>
    </message>
    <message>
        <source>Choose one of the scans</source>
        <translation>スキャンを 1 つ選んでください</translation>
    </message>
    <message>
        <source>Say how large a voxel is</source>
        <translation>ボクセルの大きさを入力してください</translation>
    </message>
    <message>
        <source>%1, %2 voxels, %3 bits each</source>
        <translation>%1、%2 ボクセル、各 %3 ビット</translation>
    </message>
    <message>
        <source>; another size was given by hand</source>
        <translation>（別の大きさを手動で入力）</translation>
    </message>
    <message>
        <source>%1 × %2 × %3 mm, read</source>
        <translation>%1 × %2 × %3 mm、読み込み済み</translation>
    </message>
    <message>
        <source>The scan does not tell it, and every millimetre depends on it. The scanner&apos;s record or report has it.</source>
        <translation>スキャンに書かれていません。すべての寸法がこの値で決まります。撮影装置の記録か報告書で確かめてください。</translation>
    </message>
    <message>
        <source>The scan says so, but it is too coarse for a tooth: some programs write 1 mm when they do not know. The scanner&apos;s record or report has it.</source>
        <translation>スキャンにはこう書かれていますが、歯には粗すぎます。不明なときに 1 mm と書くプログラムもあります。撮影装置の記録か報告書で確かめてください。</translation>
    </message>
    <message>
        <source>The scan tells it. Change it only when you know better.</source>
        <translation>スキャンに書かれている値です。確かな値を知っている場合だけ変えてください。</translation>
    </message>
    <message>
        <source>With %1 mm the tooth is 21 mm long, as a mean first molar is. Teeth differ: every millimetre of this case will be a guess.</source>
        <translation>%1 mm とすると、歯の長さは平均的な第一大臼歯と同じ 21 mm になります。歯には個体差があり、この症例の寸法はすべて推定値になります。</translation>
    </message>
    <message>
        <source>If you do not know it and the tooth is a molar, a mean one can stand in for it.</source>
        <translation>値が分からず、歯が大臼歯なら、平均的な大臼歯で代用できます。</translation>
    </message>
    <message>
        <source>Choose the scan</source>
        <translation>スキャンを選ぶ</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ReadingFields</name>
    <message>
        <source>Read only a part of it</source>
        <translation>一部だけを読む</translation>
    </message>
    <message>
        <source>Read only a part of the scan</source>
        <translation>スキャンの一部だけを読みます</translation>
    </message>
    <message>
        <source>A box around the tooth: what lies in it is read in full detail, however large the scan is</source>
        <translation>歯を囲む直方体：その中は、スキャンがどれほど大きくても細部まで読み込まれる</translation>
    </message>
    <message>
        <source>These are tissues already, not grey values</source>
        <translation>濃度値ではなく、組織のラベルである</translation>
    </message>
    <message>
        <source>This is a label volume</source>
        <translation>これはラベルボリュームです</translation>
    </message>
    <message>
        <source>A label volume from another program: teeth by FDI numbers, or 0 nothing, 1 caries, 2 enamel, 3 dentine, 4 pulp, 5 filling</source>
        <translation>ほかのプログラムで作ったラベルボリューム：FDI の番号の歯、または 0 なし、1 う蝕、2 エナメル質、3 象牙質、4 歯髄、5 充填物</translation>
    </message>
    <message>
        <source>From</source>
        <translation>始点</translation>
    </message>
    <message>
        <source>To</source>
        <translation>終点</translation>
    </message>
    <message>
        <source>From, %1</source>
        <translation>始点 %1</translation>
    </message>
    <message>
        <source>To, %1</source>
        <translation>終点 %1</translation>
    </message>
    <message>
        <source> mm</source>
        <translation> mm</translation>
    </message>
    <message>
        <source>What the numbers mean</source>
        <translation>番号の意味</translation>
    </message>
    <message>
        <source>As the file says</source>
        <translation>ファイルの記載どおり</translation>
    </message>
    <message>
        <source>Teeth, FDI (11 to 48)</source>
        <translation>歯、FDI 方式（11～48）</translation>
    </message>
    <message>
        <source>Teeth, universal (1 to 32)</source>
        <translation>歯、ユニバーサル方式（1～32）</translation>
    </message>
    <message>
        <source>Teeth, one after the other</source>
        <translation>歯、順番に</translation>
    </message>
    <message>
        <source>Tissues of one tooth</source>
        <translation>一本の歯の組織</translation>
    </message>
    <message>
        <source>Choose...</source>
        <translation>選ぶ...</translation>
    </message>
    <message>
        <source>Choose the scan that the labels were made from</source>
        <translation>ラベルの元になったスキャンを選びます</translation>
    </message>
    <message>
        <source>It shows enamel, dentine and pulp in each tooth, where the labels know only teeth</source>
        <translation>ラベルが歯だけを区別する場合、それぞれの歯のエナメル質・象牙質・歯髄を示す</translation>
    </message>
    <message>
        <source>Without</source>
        <translation>なし</translation>
    </message>
    <message>
        <source>Without the scan that the labels were made from</source>
        <translation>ラベルの元になったスキャンを使いません</translation>
    </message>
    <message>
        <source>Scan that they were made from</source>
        <translation>元になったスキャン</translation>
    </message>
    <message>
        <source>The scan that the labels were made from</source>
        <translation>ラベルの元になったスキャン</translation>
    </message>
    <message>
        <source>Scans (*.nrrd *.nhdr *.nii *.nii.gz *.mha *.mhd *.zip *.dcm *.tif *.tiff *.toml DICOMDIR);;All files (*)</source>
        <translation>スキャン (*.nrrd *.nhdr *.nii *.nii.gz *.mha *.mhd *.zip *.dcm *.tif *.tiff *.toml DICOMDIR);;すべてのファイル (*)</translation>
    </message>
    <message>
        <source>None</source>
        <translation>なし</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::DevicePage</name>
    <message>
        <source>Device</source>
        <translation>デバイス</translation>
    </message>
    <message>
        <source>What holds the handpiece</source>
        <translation>ハンドピースを動かす装置です</translation>
    </message>
    <message>
        <source>Parts of the page</source>
        <translation>ページの区分</translation>
    </message>
    <message>
        <source>Now</source>
        <translation>現在</translation>
    </message>
    <message>
        <source>Settings</source>
        <translation>設定</translation>
    </message>
    <message>
        <source>Fidelity</source>
        <translation>忠実度</translation>
    </message>
    <message>
        <source>The check has the device; the mouse holds the handpiece meanwhile.</source>
        <translation>検査中のため、その間はマウスでハンドピースを動かします。</translation>
    </message>
    <message>
        <source>The device is being opened...</source>
        <translation>デバイスを開いています...</translation>
    </message>
    <message>
        <source>The mouse holds the handpiece: choose a device in the menu Device.</source>
        <translation>マウスでハンドピースを動かしています。メニュー「デバイス」からデバイスを選んでください。</translation>
    </message>
    <message>
        <source>Checking the device</source>
        <translation>デバイスの検査</translation>
    </message>
    <message>
        <source>The check was cancelled.</source>
        <translation>検査を中止しました。</translation>
    </message>
    <message>
        <source>Save report</source>
        <translation>報告書の保存</translation>
    </message>
    <message>
        <source>Page to print (*.html);;For machines (*.json)</source>
        <translation>印刷用ページ (*.html);;機械用 (*.json)</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::DrillBar</name>
    <message>
        <source>High speed (air turbine)</source>
        <translation>高速（エアタービン）</translation>
    </message>
    <message>
        <source>High speed, weak air</source>
        <translation>高速（弱いエア）</translation>
    </message>
    <message>
        <source>Bur in hand</source>
        <translation>使用中のバー</translation>
    </message>
    <message>
        <source>Find a bur</source>
        <translation>バーを探す</translation>
    </message>
    <message>
        <source>Find a bur by name, US or ISO number, diameter or shape</source>
        <translation>名前、US 番号、ISO 番号、直径、形でバーを探します</translation>
    </message>
    <message>
        <source>Shape of the burs shown</source>
        <translation>表示するバーの形</translation>
    </message>
    <message>
        <source>Burs</source>
        <translation>バー</translation>
    </message>
    <message>
        <source>Choose a bur: click, or arrow keys and Enter</source>
        <translation>バーを選びます：クリック、または矢印キーと Enter</translation>
    </message>
    <message>
        <source>Own bur from a file…</source>
        <translation>自作のバーを開く…</translation>
    </message>
    <message>
        <source>Open an own bur</source>
        <translation>自作のバーを開く</translation>
    </message>
    <message>
        <source>Use a bur of your own from an STL file</source>
        <translation>自作のバーを STL ファイルから読み込みます</translation>
    </message>
    <message>
        <source>Handpiece</source>
        <translation>ハンドピース</translation>
    </message>
    <message>
        <source>Drive</source>
        <translation>駆動方式</translation>
    </message>
    <message>
        <source>The bur has stopped</source>
        <translation>バーが止まりました</translation>
    </message>
    <message>
        <source>Speed</source>
        <translation>回転数</translation>
    </message>
    <message>
        <source>Set speed</source>
        <translation>設定回転数</translation>
    </message>
    <message>
        <source>Set speed, with the pedal down and the bur in the air (+ and -)</source>
        <translation>ペダルを踏み、バーが何にも触れていないときの回転数です（+ と -）</translation>
    </message>
    <message>
        <source>Set speed in rpm</source>
        <translation>設定回転数（rpm）</translation>
    </message>
    <message>
        <source> rpm</source>
        <translation> rpm</translation>
    </message>
    <message>
        <source>All shapes</source>
        <translation>すべての形</translation>
    </message>
    <message>
        <source>This exercise allows only the burs that are not grey.</source>
        <translation>この課題では、灰色でないバーだけを使えます。</translation>
    </message>
    <message>
        <source>None</source>
        <translation>なし</translation>
    </message>
    <message>
        <source>Own bur</source>
        <translation>自作のバー</translation>
    </message>
    <message>
        <source>mm</source>
        <translation>mm</translation>
    </message>
    <message>
        <source>US %1</source>
        <translation>US %1</translation>
    </message>
    <message>
        <source>ISO %1</source>
        <translation>ISO %1</translation>
    </message>
    <message>
        <source>Up to %1 rpm</source>
        <translation>最高 %1 rpm</translation>
    </message>
    <message>
        <source>The bur has stopped: press less hard.</source>
        <translation>バーが止まりました。押す力を弱めてください。</translation>
    </message>
    <message>
        <source>Stalled: the load is more than the drive can turn.</source>
        <translation>停止：荷重が大きすぎて回転できません。</translation>
    </message>
    <message>
        <source>Low speed</source>
        <translation>低速</translation>
    </message>
    <message>
        <source>Red band 1:5 (speed-increasing)</source>
        <translation>5 倍速コントラ（赤帯 1:5）</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ErrorDialog</name>
    <message>
        <source>That did not work</source>
        <translation>実行できませんでした</translation>
    </message>
    <message>
        <source>Copy text</source>
        <translation>文をコピー</translation>
    </message>
    <message>
        <source>Copy this message, to send it to somebody</source>
        <translation>このメッセージをコピーして、人に送れるようにします</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ExerciseFeature</name>
    <message>
        <source>Handed in</source>
        <translation>提出済み</translation>
    </message>
    <message>
        <source>This attempt was handed in.</source>
        <translation>これは提出された課題の結果です。</translation>
    </message>
    <message>
        <source>This attempt was handed in by %1.</source>
        <translation>これは %1 が提出した課題の結果です。</translation>
    </message>
    <message>
        <source>Look at it with every help: measure, cut it open, watch what was recorded. Or go on cutting where it ended, as the exercise has it.</source>
        <translation>すべての機能を使って見る: 測定し、断面を開き、記録を再生します。または、課題の条件のまま、終わったところから切削を続けます。</translation>
    </message>
    <message>
        <source>Look at it</source>
        <translation>見る</translation>
    </message>
    <message>
        <source>Go on with it</source>
        <translation>続ける</translation>
    </message>
    <message>
        <source>Hand in</source>
        <translation>提出</translation>
    </message>
    <message>
        <source>Whose work is it? Your code, given by your teacher: no name. It is asked once; change it with File, Your code.</source>
        <translation>誰の結果ですか。先生から渡されたコードを入力してください（名前は不要です）。尋ねるのは一度だけで、「ファイル」の「受講者コード」で変更できます。</translation>
    </message>
    <message>
        <source>Exercise</source>
        <translation>課題</translation>
    </message>
    <message>
        <source>The code your teacher gave you: File, Your code...</source>
        <translation>先生から渡されたコード：ファイル、受講者コード...</translation>
    </message>
    <message>
        <source>Attempt with its tooth (*.handpiece)</source>
        <translation>作業と歯 (*.handpiece)</translation>
    </message>
    <message>
        <source>Your code</source>
        <translation>受講者コード</translation>
    </message>
    <message>
        <source>Code (given by your teacher). No name: recordings and saved attempts carry it.</source>
        <translation>先生から渡されたコード。記録と保存した作業に入るため、名前は書かないでください。</translation>
    </message>
    <message>
        <source>Code: %1</source>
        <translation>コード：%1</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ExercisePanel</name>
    <message>
        <source>Exercise</source>
        <translation>課題</translation>
    </message>
    <message>
        <source>Title of the exercise</source>
        <translation>課題の題名</translation>
    </message>
    <message>
        <source>What to do</source>
        <translation>指示</translation>
    </message>
    <message>
        <source>Go on with it</source>
        <translation>続ける</translation>
    </message>
    <message>
        <source>Cut on where it ended; what the exercise locks is locked then</source>
        <translation>終わったところから切削を続けます。課題のロックが有効になります</translation>
    </message>
    <message>
        <source>Without a title</source>
        <translation>題名なし</translation>
    </message>
    <message>
        <source>Not in this exercise: %1</source>
        <translation>この課題では使えないもの: %1</translation>
    </message>
    <message>
        <source>Handed in without a code. You look at it: nothing is locked.</source>
        <translation>コードなしで提出されました。閲覧中: ロックはありません。</translation>
    </message>
    <message>
        <source>Handed in by %1. You look at it: nothing is locked.</source>
        <translation>%1 が提出しました。閲覧中: ロックはありません。</translation>
    </message>
    <message>
        <source>Watch recording %1</source>
        <translation>記録 %1 を再生</translation>
    </message>
    <message>
        <source>Play what was done; closing it leads back here</source>
        <translation>行ったことを再生します。閉じるとここに戻ります</translation>
    </message>
    <message>
        <source>Recordings that did not come with it: %1</source>
        <translation>含まれていない記録: %1</translation>
    </message>
    <message>
        <source>Finish</source>
        <translation>完了</translation>
    </message>
    <message>
        <source>Your work on this exercise is done: it is judged, and you see why</source>
        <translation>この課題の作業を終えて採点し、その理由を表示します</translation>
    </message>
    <message>
        <source>Time worked</source>
        <translation>作業時間</translation>
    </message>
    <message>
        <source>Removed of the target</source>
        <translation>目標のうち削除した割合</translation>
    </message>
    <message>
        <source>Target: %p %</source>
        <translation>目標：%p %</translation>
    </message>
    <message>
        <source>Time: %1 of %2</source>
        <translation>時間：%1 / %2</translation>
    </message>
    <message>
        <source>Time: %1 of %2, over by %3</source>
        <translation>時間：%1 / %2、超過 %3</translation>
    </message>
    <message>
        <source>Leeway used: %1 mm³</source>
        <translation>許容範囲の切削：%1 mm³</translation>
    </message>
    <message>
        <source>Beyond it: %1 mm³</source>
        <translation>許容範囲の外：%1 mm³</translation>
    </message>
    <message>
        <source>Protected, and cut: %1 mm³</source>
        <translation>保護部位の切削：%1 mm³</translation>
    </message>
    <message>
        <source>Target: –</source>
        <translation>目標：–</translation>
    </message>
    <message>
        <source>Being worked out</source>
        <translation>計算中</translation>
    </message>
    <message>
        <source>Nothing beside the target</source>
        <translation>目標の外は切削なし</translation>
    </message>
    <message>
        <source>Undo takes back the whole stroke, with what it did to gingiva and adjacent teeth. How often you undo is kept with the work.</source>
        <translation>「元に戻す」は、歯肉や隣在歯に与えた傷も含めてストローク全体を取り消します。取り消した回数は作業とともに残ります。</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::FdiPicker</name>
    <message>
        <source>FDI number of the tooth</source>
        <translation>歯の FDI 番号</translation>
    </message>
    <message>
        <source>Two digits: quadrant and place, 46 for the lower right first molar</source>
        <translation>2 桁の数字：顎の区分と位置。下顎右側第一大臼歯は 46</translation>
    </message>
    <message>
        <source>Chart...</source>
        <translation>歯列図...</translation>
    </message>
    <message>
        <source>Choose the tooth on the chart of the mouth</source>
        <translation>歯列図から歯を選びます</translation>
    </message>
    <message>
        <source>not said yet</source>
        <translation>未入力</translation>
    </message>
    <message>
        <source>There is no tooth %1</source>
        <translation>%1 という歯はありません</translation>
    </message>
    <message>
        <source>Which tooth is it?</source>
        <translation>どの歯ですか</translation>
    </message>
    <message>
        <source>Primary teeth too</source>
        <translation>乳歯も表示</translation>
    </message>
    <message>
        <source>Show the primary teeth inside the arches</source>
        <translation>歯列の内側に乳歯を表示します</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::FidelityBox</name>
    <message>
        <source>How good this station feels</source>
        <translation>この装置の手ごたえ</translation>
    </message>
    <message>
        <source>Measures the device with this computer: how evenly its servo runs, how late a force comes, its noise and limits. Nothing else has the device meanwhile.</source>
        <translation>このコンピューターでデバイスを測ります：サーボの規則正しさ、力の遅れ、雑音、限界。その間、デバイスはほかには使えません。</translation>
    </message>
    <message>
        <source>Check now</source>
        <translation>検査する</translation>
    </message>
    <message>
        <source>Measures for as long as the field beside it says</source>
        <translation>右の欄の時間だけ測ります</translation>
    </message>
    <message>
        <source>Seconds</source>
        <translation>秒数</translation>
    </message>
    <message>
        <source>How long to measure</source>
        <translation>測る時間です</translation>
    </message>
    <message>
        <source> s</source>
        <translation> 秒</translation>
    </message>
    <message>
        <source>Push lightly</source>
        <translation>軽く押す</translation>
    </message>
    <message>
        <source>Pushes the stylus with a small known force to measure slope and delay: hold it loosely. Without it these are not measured.</source>
        <translation>決まった小さな力でスタイラスを押し、立ち上がりと遅れを測ります。軽く持ってください。押さない場合、これらは測りません。</translation>
    </message>
    <message>
        <source>Progress of the check</source>
        <translation>検査の進み具合</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>中止</translation>
    </message>
    <message>
        <source>Stops the check</source>
        <translation>検査を止めます</translation>
    </message>
    <message>
        <source>Result of the check</source>
        <translation>検査の結果</translation>
    </message>
    <message>
        <source>Findings</source>
        <translation>所見</translation>
    </message>
    <message>
        <source>Each finding with its figure; what to do stands below those that did not pass</source>
        <translation>所見とその値です。合格しなかったものには、対処が下に示されます</translation>
    </message>
    <message>
        <source>Result</source>
        <translation>結果</translation>
    </message>
    <message>
        <source>What</source>
        <translation>項目</translation>
    </message>
    <message>
        <source>Figure</source>
        <translation>値</translation>
    </message>
    <message>
        <source>Save report...</source>
        <translation>報告書の保存...</translation>
    </message>
    <message>
        <source>As a page to print (HTML) or for machines (JSON)</source>
        <translation>印刷用ページ（HTML）または機械用（JSON）で保存します</translation>
    </message>
    <message>
        <source>Passed</source>
        <translation>合格</translation>
    </message>
    <message>
        <source>Look at this</source>
        <translation>要確認</translation>
    </message>
    <message>
        <source>Failed</source>
        <translation>不合格</translation>
    </message>
    <message>
        <source>Not measured</source>
        <translation>未測定</translation>
    </message>
    <message>
        <source>Choose a device in the menu Device first</source>
        <translation>先にメニュー「デバイス」からデバイスを選んでください</translation>
    </message>
    <message>
        <source>Measuring...</source>
        <translation>測定中...</translation>
    </message>
    <message>
        <source>Failed: %1. To look at: %2.</source>
        <translation>不合格：%1、要確認：%2。</translation>
    </message>
    <message>
        <source>Nothing failed. To look at: %1.</source>
        <translation>不合格はありません。要確認：%1。</translation>
    </message>
    <message>
        <source>All that could be measured has passed.</source>
        <translation>測れた項目はすべて合格です。</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::FirstPlugIn</name>
    <message>
        <source>Set up the device</source>
        <translation>デバイスの準備</translation>
    </message>
    <message>
        <source>Step</source>
        <translation>手順</translation>
    </message>
    <message>
        <source>Later</source>
        <translation>あとで</translation>
    </message>
    <message>
        <source>Work with what fits the model; Device, Set up... comes back here</source>
        <translation>機種に合った設定で作業します。「デバイス」→「準備」でここに戻れます</translation>
    </message>
    <message>
        <source>Back</source>
        <translation>戻る</translation>
    </message>
    <message>
        <source>To the step before</source>
        <translation>前の手順へ</translation>
    </message>
    <message>
        <source>Next</source>
        <translation>次へ</translation>
    </message>
    <message>
        <source>Connection</source>
        <translation>接続</translation>
    </message>
    <message>
        <source>What to do</source>
        <translation>すること</translation>
    </message>
    <message>
        <source>Calibration</source>
        <translation>校正</translation>
    </message>
    <message>
        <source>Calibrate</source>
        <translation>校正する</translation>
    </message>
    <message>
        <source>Asks the device to take its place anew</source>
        <translation>デバイスに位置を取り直させます</translation>
    </message>
    <message>
        <source>1 of 3: Connect</source>
        <translation>1／3：接続</translation>
    </message>
    <message>
        <source>2 of 3: Calibrate</source>
        <translation>2／3：校正</translation>
    </message>
    <message>
        <source>3 of 3: Feel a block</source>
        <translation>3／3：ブロックに触れる</translation>
    </message>
    <message>
        <source>Finish</source>
        <translation>完了</translation>
    </message>
    <message>
        <source>Keeps this for the device and takes it to the tooth</source>
        <translation>この設定をデバイス用に保存し、歯に移ります</translation>
    </message>
    <message>
        <source>To the next step</source>
        <translation>次の手順へ</translation>
    </message>
    <message>
        <source>Lower the stylus onto the block: it should feel hard, and the line shows how it pushes back. Choose what suits your hand.</source>
        <translation>スタイラスをブロックの上に下ろしてください。硬く感じられ、押し返す力が線で示されます。手に合うものを選んでください。</translation>
    </message>
    <message>
        <source>The device is being opened...</source>
        <translation>デバイスを開いています...</translation>
    </message>
    <message>
        <source>The device is not there. Connect it and choose it again in the menu Device. The mouse works meanwhile.</source>
        <translation>デバイスがありません。接続し、メニュー「デバイス」からもう一度選んでください。その間はマウスが使えます。</translation>
    </message>
    <message>
        <source>Waiting for the device&apos;s first answer...</source>
        <translation>デバイスの最初の応答を待っています...</translation>
    </message>
    <message>
        <source>The device answers. Move the stylus: the picture follows.</source>
        <translation>デバイスが応答しています。スタイラスを動かすと、図も動きます。</translation>
    </message>
    <message>
        <source>This device calibrates by itself.</source>
        <translation>このデバイスは自動で校正されます。</translation>
    </message>
    <message>
        <source>Calibrated.</source>
        <translation>校正済みです。</translation>
    </message>
    <message>
        <source>Not calibrated yet.</source>
        <translation>まだ校正されていません。</translation>
    </message>
    <message>
        <source>Press Calibrate.</source>
        <translation>「校正する」を押してください。</translation>
    </message>
    <message>
        <source>Nothing is to be done. You may calibrate again.</source>
        <translation>何もする必要はありません。もう一度校正することもできます。</translation>
    </message>
    <message>
        <source>Calibrating...</source>
        <translation>校正中...</translation>
    </message>
    <message>
        <source>Not calibrated yet. Do as it says above, then try again.</source>
        <translation>まだ校正されていません。上の説明のとおりにして、もう一度試してください。</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ForceGauge</name>
    <message>
        <source>How hard the bur presses</source>
        <translation>バーを押す力</translation>
    </message>
    <message>
        <source>How hard the bur presses. The line is the highest of the last two seconds.</source>
        <translation>バーを押す力です。線は直前 2 秒間の最大値を示します。</translation>
    </message>
    <message>
        <source>N</source>
        <translation>N</translation>
    </message>
    <message>
        <source>At the limit</source>
        <translation>限界です</translation>
    </message>
    <message>
        <source>Pressure</source>
        <translation>押す力</translation>
    </message>
    <message>
        <source>Force</source>
        <translation>力</translation>
    </message>
    <message>
        <source>peak %1</source>
        <translation>最大 %1</translation>
    </message>
    <message>
        <source>limit %1</source>
        <translation>限界 %1</translation>
    </message>
    <message>
        <source>More than the device gives</source>
        <translation>装置の限界</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::DeviceManager</name>
    <message>
        <source>Looking for devices</source>
        <translation>デバイスを探しています</translation>
    </message>
    <message>
        <source>Opening the device</source>
        <translation>デバイスを開いています</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::GuideDialog</name>
    <message>
        <source>User guide</source>
        <translation>使い方の手引き</translation>
    </message>
    <message>
        <source>Find in the guide</source>
        <translation>手引きの中を探す</translation>
    </message>
    <message>
        <source>Type a word; Enter finds the next place</source>
        <translation>語を入力します。Enter で次の箇所に進みます</translation>
    </message>
    <message>
        <source>Chapters</source>
        <translation>章</translation>
    </message>
    <message>
        <source>Go to this chapter</source>
        <translation>この章に移ります</translation>
    </message>
    <message>
        <source>That page is in the package handpiece-doc: %1</source>
        <translation>そのページはパッケージ handpiece-doc にあります: %1</translation>
    </message>
    <message>
        <source>No program here opens %1</source>
        <translation>%1 を開くプログラムがありません</translation>
    </message>
    <message>
        <source>Not found: %1</source>
        <translation>見つかりません: %1</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::HelpCard</name>
    <message>
        <source>%1: %2</source>
        <translation>%1：%2</translation>
    </message>
    <message>
        <source>Click or press a key to close</source>
        <translation>クリックするか、キーを押すと閉じます</translation>
    </message>
    <message>
        <source>The window</source>
        <translation>ウィンドウ</translation>
    </message>
    <message>
        <source>Keys and mouse</source>
        <translation>キーとマウス</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::HistogramView</name>
    <message>
        <source>tooth from</source>
        <translation>歯の下限</translation>
    </message>
    <message>
        <source>enamel from</source>
        <translation>エナメル質の下限</translation>
    </message>
    <message>
        <source>filling from</source>
        <translation>充填物の下限</translation>
    </message>
    <message>
        <source>Grey values and where tissues begin</source>
        <translation>濃度値と組織の境目</translation>
    </message>
    <message>
        <source>Drag a handle to say where a tissue begins. Keys: Up and Down choose a handle, Left and Right move it.</source>
        <translation>つまみをドラッグして組織の始まりを決めます。キー：上下でつまみを選び、左右で動かします。</translation>
    </message>
    <message>
        <source>none</source>
        <translation>なし</translation>
    </message>
    <message>
        <source>Grey values appear when the scan is read</source>
        <translation>スキャンを読み込むと濃度値が表示されます</translation>
    </message>
    <message>
        <source>set by hand</source>
        <translation>手動で設定</translation>
    </message>
    <message>
        <source>found by the program</source>
        <translation>自動で決定</translation>
    </message>
    <message>
        <source>no filling</source>
        <translation>充填物なし</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::JobStrip</name>
    <message>
        <source>Progress</source>
        <translation>進み具合</translation>
    </message>
    <message>
        <source>How far it is</source>
        <translation>どこまで進んだかを示します</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>中止</translation>
    </message>
    <message>
        <source>Stop this; what was open stays as it is</source>
        <translation>この処理を中止します。開いていたものはそのまま残ります</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::KeyBindingsDialog</name>
    <message>
        <source>Actions and their keys</source>
        <translation>操作とキーの一覧</translation>
    </message>
    <message>
        <source>Choose a key, then press Change</source>
        <translation>キーを選んでから「変更」を押します</translation>
    </message>
    <message>
        <source>Action</source>
        <translation>操作</translation>
    </message>
    <message>
        <source>Key or button</source>
        <translation>キーまたはボタン</translation>
    </message>
    <message>
        <source>Or</source>
        <translation>または</translation>
    </message>
    <message>
        <source>Change</source>
        <translation>変更</translation>
    </message>
    <message>
        <source>Then press the new key or mouse button</source>
        <translation>続けて新しいキーかマウスボタンを押します</translation>
    </message>
    <message>
        <source>Clear</source>
        <translation>消去</translation>
    </message>
    <message>
        <source>Leave this place without a key</source>
        <translation>この欄のキーをなくします</translation>
    </message>
    <message>
        <source>Take it over</source>
        <translation>置き換える</translation>
    </message>
    <message>
        <source>The other action loses this key</source>
        <translation>もう一方の操作からこのキーを外します</translation>
    </message>
    <message>
        <source>Right-handed</source>
        <translation>右手用</translation>
    </message>
    <message>
        <source>As delivered, with the mouse in the right hand</source>
        <translation>最初の設定です。マウスを右手で使います</translation>
    </message>
    <message>
        <source>Left-handed</source>
        <translation>左手用</translation>
    </message>
    <message>
        <source>With the mouse in the left hand</source>
        <translation>マウスを左手で使います</translation>
    </message>
    <message>
        <source>%1 is already used for &quot;%2&quot;.</source>
        <translation>%1 はすでに「%2」に使われています。</translation>
    </message>
    <message>
        <source>&quot;%1&quot; cannot be done with %2.</source>
        <translation>「%1」に %2 は使えません。</translation>
    </message>
    <message>
        <source>Press the new key, mouse button or turn the wheel; %1 leaves it as it is.</source>
        <translation>新しいキーかマウスボタンを押すか、ホイールを回してください。%1 で元のままにします。</translation>
    </message>
    <message>
        <source>Keys and mouse</source>
        <translation>キーとマウス</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::LiveBox</name>
    <message>
        <source>How the device is doing</source>
        <translation>デバイスの状態</translation>
    </message>
    <message>
        <source>Force on the hand</source>
        <translation>手にかかる力</translation>
    </message>
    <message>
        <source>What the device pushes the hand with. The line is the highest of the last two seconds.</source>
        <translation>デバイスが手を押す力です。線は過去2秒の最大値です。</translation>
    </message>
    <message>
        <source>Device</source>
        <translation>デバイス</translation>
    </message>
    <message>
        <source>As its maker calls it, and the version of its software</source>
        <translation>製造元による名前と、ソフトウェアの版です</translation>
    </message>
    <message>
        <source>Place</source>
        <translation>位置</translation>
    </message>
    <message>
        <source>Of the stylus: to the right, up, and to the user</source>
        <translation>スタイラスの位置：右、上、手前の順です</translation>
    </message>
    <message>
        <source>Buttons</source>
        <translation>ボタン</translation>
    </message>
    <message>
        <source>The upper one cuts; the lower one, held, undoes</source>
        <translation>上のボタンで切削し、下のボタンを押し続けると元に戻します</translation>
    </message>
    <message>
        <source>Force sent</source>
        <translation>送った力</translation>
    </message>
    <message>
        <source>To the right, up, and to the user; after all limits</source>
        <translation>右、上、手前の順で、すべての制限のあとの値です</translation>
    </message>
    <message>
        <source>Motors</source>
        <translation>モーター</translation>
    </message>
    <message>
        <source>Warmth as the device tells it, and as the thermal budget counts it</source>
        <translation>デバイスの知らせる温度と、熱の予算で数えた値です</translation>
    </message>
    <message>
        <source>Servo</source>
        <translation>サーボ</translation>
    </message>
    <message>
        <source>How often the device&apos;s own loop asks for a force</source>
        <translation>デバイス自身のループが力を求める頻度です</translation>
    </message>
    <message>
        <source>Lateness</source>
        <translation>遅れ</translation>
    </message>
    <message>
        <source>How late the force loop begins, of 100 ticks the latest</source>
        <translation>力のループの始まりの遅れです。100回のうち最も遅い値です</translation>
    </message>
    <message>
        <source>Real time</source>
        <translation>リアルタイム</translation>
    </message>
    <message>
        <source>What the machine grants the force loop: without real time some ticks come late</source>
        <translation>この機械が力のループに許すものです。リアルタイムでないと計算が遅れることがあります</translation>
    </message>
    <message>
        <source>Passivity</source>
        <translation>受動性</translation>
    </message>
    <message>
        <source>How often the controller had to take energy out</source>
        <translation>制御器がエネルギーを取り除いた回数です</translation>
    </message>
    <message>
        <source>Trouble</source>
        <translation>異常</translation>
    </message>
    <message>
        <source>Why it gives no force</source>
        <translation>力を出さない理由です</translation>
    </message>
    <message>
        <source>mm</source>
        <translation>mm</translation>
    </message>
    <message>
        <source>upper</source>
        <translation>上</translation>
    </message>
    <message>
        <source>lower</source>
        <translation>下</translation>
    </message>
    <message>
        <source>number %1</source>
        <translation>%1 番</translation>
    </message>
    <message>
        <source>clutch held</source>
        <translation>クラッチ中</translation>
    </message>
    <message>
        <source>none pressed</source>
        <translation>押されていません</translation>
    </message>
    <message>
        <source>N</source>
        <translation>N</translation>
    </message>
    <message>
        <source>gives no force</source>
        <translation>力を出しません</translation>
    </message>
    <message>
        <source>%1 % of what is allowed; budget %2 % used</source>
        <translation>許容の %1 %、予算の使用 %2 %</translation>
    </message>
    <message>
        <source>not told; budget %1 % used</source>
        <translation>不明、予算の使用 %1 %</translation>
    </message>
    <message>
        <source>%1 Hz (%2 by design), frames: %3</source>
        <translation>%1 Hz（設計値 %2）、フレーム：%3</translation>
    </message>
    <message>
        <source>controller engaged in ticks: %1</source>
        <translation>制御器が働いたティック：%1</translation>
    </message>
    <message>
        <source>none</source>
        <translation>なし</translation>
    </message>
    <message>
        <source>p99 %1 µs; late ticks: %2, missed: %3</source>
        <translation>p99 %1 µs、遅れたティック：%2、欠け：%3</translation>
    </message>
    <message>
        <source>Mouse and keyboard</source>
        <translation>マウスとキーボード</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::DeviceFeature</name>
    <message>
        <source>Device by name or serial</source>
        <translation>名前またはシリアル番号で装置を選ぶ</translation>
    </message>
    <message>
        <source>One of %1; a colon; then the device&apos;s name, serial or number.
openhaptics:Left Arm, or forcedimension:2</source>
        <translation>%1 のどれか、コロン、続けて装置の名前・シリアル番号・番号を入力します。
例: openhaptics:Left Arm、forcedimension:2</translation>
    </message>
    <message>
        <source>Mouse and keyboard</source>
        <translation>マウスとキーボード</translation>
    </message>
    <message>
        <source>Always there</source>
        <translation>いつでも使えます</translation>
    </message>
    <message>
        <source>Gives force</source>
        <translation>力を出します</translation>
    </message>
    <message>
        <source>Moves the handpiece, gives no force</source>
        <translation>ハンドピースを動かします。力は出しません</translation>
    </message>
    <message>
        <source>%1: not there</source>
        <translation>%1：ありません</translation>
    </message>
    <message>
        <source>Looking...</source>
        <translation>探しています...</translation>
    </message>
    <message>
        <source>being opened</source>
        <translation>開いています</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::Docks</name>
    <message>
        <source>Show or hide this panel</source>
        <translation>このパネルの表示を切り替えます</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::DrillFeature</name>
    <message>
        <source>Handpiece</source>
        <translation>ハンドピース</translation>
    </message>
    <message>
        <source>Pressure</source>
        <translation>押す力</translation>
    </message>
    <message>
        <source>Parameters</source>
        <translation>パラメーター</translation>
    </message>
    <message>
        <source>A bur of your own</source>
        <translation>自作のバー</translation>
    </message>
    <message>
        <source>Surfaces (*.stl *.ply *.obj)</source>
        <translation>曲面 (*.stl *.ply *.obj)</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::FilesFeature</name>
    <message>
        <source>Recording of %1, %2</source>
        <translation>%1 の記録（%2）</translation>
    </message>
    <message>
        <source>Open recent</source>
        <translation>最近使ったファイル</translation>
    </message>
    <message>
        <source>Open case</source>
        <translation>症例を開く</translation>
    </message>
    <message>
        <source>Cases and attempts (*.handpiece case.toml attempt.toml);;All files (*)</source>
        <translation>症例と作業 (*.handpiece case.toml attempt.toml);;すべてのファイル (*)</translation>
    </message>
    <message>
        <source>Open STL</source>
        <translation>STL を開く</translation>
    </message>
    <message>
        <source>Surfaces (*.stl *.ply *.obj);;All files (*)</source>
        <translation>曲面 (*.stl *.ply *.obj);;すべてのファイル (*)</translation>
    </message>
    <message>
        <source>Export STL</source>
        <translation>STL に書き出す</translation>
    </message>
    <message>
        <source>STL (*.stl)</source>
        <translation>STL (*.stl)</translation>
    </message>
    <message>
        <source>Folder for the tissues</source>
        <translation>組織の書き出し先フォルダー</translation>
    </message>
    <message>
        <source>Write the report</source>
        <translation>レポートを書き出す</translation>
    </message>
    <message>
        <source>Page to print (*.html)</source>
        <translation>印刷用ページ (*.html)</translation>
    </message>
    <message>
        <source>Save what was cut?</source>
        <translation>切削した歯を保存しますか？</translation>
    </message>
    <message>
        <source>The tooth has been cut since it was saved.</source>
        <translation>保存した後に、さらに切削しています。</translation>
    </message>
    <message>
        <source>Without saving, it can only be watched in the recording, not cut on.</source>
        <translation>保存しないと、記録を見ることはできますが、切削の続きはできません。</translation>
    </message>
    <message>
        <source>Save the attempt</source>
        <translation>作業を保存</translation>
    </message>
    <message>
        <source>Attempt with its tooth (*.handpiece)</source>
        <translation>作業と歯 (*.handpiece)</translation>
    </message>
    <message>
        <source>Keep the picture</source>
        <translation>画像を保存</translation>
    </message>
    <message>
        <source>Picture (*.png)</source>
        <translation>画像 (*.png)</translation>
    </message>
    <message>
        <source>Open it again</source>
        <translation>もう一度開きます</translation>
    </message>
    <message>
        <source>Mend...</source>
        <translation>修復...</translation>
    </message>
    <message>
        <source>Close holes and turn faces; nothing is written unasked</source>
        <translation>穴を閉じ、面の向きをそろえます。指示なしには何も書き込みません</translation>
    </message>
    <message>
        <source>%1-mended.stl</source>
        <translation>%1-修復済み.stl</translation>
    </message>
    <message>
        <source>Save the mended surface</source>
        <translation>修復した表面の保存</translation>
    </message>
    <message>
        <source>Surfaces (*.stl *.ply)</source>
        <translation>表面 (*.stl *.ply)</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::LayoutFeature</name>
    <message>
        <source>As the desktop</source>
        <translation>デスクトップに合わせる</translation>
    </message>
    <message>
        <source>The language of the window</source>
        <translation>ウィンドウの言語</translation>
    </message>
    <message>
        <source>About Handpiece</source>
        <translation>Handpiece について</translation>
    </message>
    <message>
        <source>&lt;h3&gt;Handpiece %1&lt;/h3&gt;&lt;p&gt;An open dental surgery simulator: touch a tooth and cut it.&lt;/p&gt;</source>
        <translation>&lt;h3&gt;Handpiece %1&lt;/h3&gt;&lt;p&gt;オープンな歯科手術シミュレーターです。歯に触れ、削ることができます。&lt;/p&gt;</translation>
    </message>
    <message>
        <source>&lt;p&gt;Licensed under the Apache License 2.0. For teaching; no medical device.&lt;/p&gt;&lt;p&gt;It stands on: Qt %1 (LGPL 3), OpenAL Soft (LGPL 2), Mesa (MIT), Eigen (MPL 2), fmt (MIT), oneTBB (Apache 2.0), Qhull (Qhull licence), HDF5 (BSD), libzip (BSD), SQLite (public domain), zlib (zlib), libpng (libpng), toml++ (MIT), nlohmann-json (MIT), CLI11 (BSD).&lt;/p&gt;&lt;p&gt;Draws with: %2&lt;/p&gt;&lt;p&gt;Sound: %3&lt;/p&gt;</source>
        <translation>&lt;p&gt;Apache License 2.0 で公開しています。教育用であり、医療機器ではありません。&lt;/p&gt;&lt;p&gt;使用しているソフトウェア：Qt %1 (LGPL 3)、OpenAL Soft (LGPL 2)、Mesa (MIT)、Eigen (MPL 2)、fmt (MIT)、oneTBB (Apache 2.0)、Qhull (Qhull licence)、HDF5 (BSD)、libzip (BSD)、SQLite (パブリックドメイン)、zlib (zlib)、libpng (libpng)、toml++ (MIT)、nlohmann-json (MIT)、CLI11 (BSD)。&lt;/p&gt;&lt;p&gt;描画：%2&lt;/p&gt;&lt;p&gt;音：%3&lt;/p&gt;</translation>
    </message>
    <message>
        <source>nothing yet</source>
        <translation>まだありません</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::MeasureFeature</name>
    <message>
        <source>Measure</source>
        <translation>計測</translation>
    </message>
    <message>
        <source>Removed</source>
        <translation>切削量</translation>
    </message>
    <message>
        <source>Plots</source>
        <translation>グラフ</translation>
    </message>
    <message>
        <source>Pulp</source>
        <translation>歯髄</translation>
    </message>
    <message>
        <source>Save the plots</source>
        <translation>グラフを保存</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::RecoveryFeature</name>
    <message>
        <source>Work that ended without saving</source>
        <translation>保存されずに終わった作業</translation>
    </message>
    <message>
        <source>There is none: everything was saved or given up.</source>
        <translation>ありません。すべて保存または破棄されています。</translation>
    </message>
    <message>
        <source>Choose what to bring back:</source>
        <translation>復元するものを選んでください：</translation>
    </message>
    <message>
        <source>The newest first</source>
        <translation>新しい順に並んでいます</translation>
    </message>
    <message>
        <source>%1, %2</source>
        <translation>%1、%2</translation>
    </message>
    <message>
        <source>Bring it back</source>
        <translation>復元する</translation>
    </message>
    <message>
        <source>Open the tooth as it was when the program ended</source>
        <translation>プログラムが終わったときの状態で歯を開きます</translation>
    </message>
    <message>
        <source>Give it up</source>
        <translation>破棄する</translation>
    </message>
    <message>
        <source>It is not offered again; its recording stays for a while</source>
        <translation>次からは表示されません。記録はしばらく残ります</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::RadiographDialog</name>
    <message>
        <source>View</source>
        <translation>撮影法</translation>
    </message>
    <message>
        <source>Tooth</source>
        <translation>歯</translation>
    </message>
    <message>
        <source>FDI number of the tooth in the middle</source>
        <translation>中央に置く歯の FDI 番号</translation>
    </message>
    <message>
        <source>Radiograph</source>
        <translation>X 線画像</translation>
    </message>
    <message>
        <source>About the radiograph</source>
        <translation>X 線画像について</translation>
    </message>
    <message>
        <source>Taking the radiograph</source>
        <translation>X 線画像を計算しています</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>キャンセル</translation>
    </message>
    <message>
        <source>Save...</source>
        <translation>保存...</translation>
    </message>
    <message>
        <source>Write the radiograph as PNG or DICOM, marked as simulated</source>
        <translation>PNG または DICOM として保存します（模擬画像と明記）</translation>
    </message>
    <message>
        <source>Radiograph (simulated)</source>
        <translation>X 線画像（模擬）</translation>
    </message>
    <message>
        <source>Bitewing</source>
        <translation>咬翼法（バイトウィング）</translation>
    </message>
    <message>
        <source>Periapical</source>
        <translation>根尖投影法（デンタル）</translation>
    </message>
    <message>
        <source>Cancelled. Choose a view to take it again.</source>
        <translation>中止しました。撮影法を選ぶと撮り直します。</translation>
    </message>
    <message>
        <source>Computed from the teeth as they are cut now: for learning, not for diagnosis.</source>
        <translation>現在の切削状態の歯から計算した画像です。学習用であり、診断用ではありません。</translation>
    </message>
    <message>
        <source>Take again</source>
        <translation>撮り直す</translation>
    </message>
    <message>
        <source>Of the teeth as they are cut now</source>
        <translation>現在の切削状態の歯を撮影します</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::RadiographFeature</name>
    <message>
        <source>Save the radiograph</source>
        <translation>X 線画像を保存</translation>
    </message>
    <message>
        <source>PNG (*.png);;DICOM (*.dcm)</source>
        <translation>PNG (*.png);;DICOM (*.dcm)</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ReplayFeature</name>
    <message>
        <source>Another way of working</source>
        <translation>作業方法の変更</translation>
    </message>
    <message>
        <source>Open recording</source>
        <translation>記録を開く</translation>
    </message>
    <message>
        <source>Recordings (*.h5);;All files (*)</source>
        <translation>記録 (*.h5);;すべてのファイル (*)</translation>
    </message>
    <message>
        <source>Keep the recording</source>
        <translation>記録を保存</translation>
    </message>
    <message>
        <source>Recording (*.h5)</source>
        <translation>記録 (*.h5)</translation>
    </message>
    <message>
        <source>Stroke begins</source>
        <translation>ストローク開始</translation>
    </message>
    <message>
        <source>Stroke ends</source>
        <translation>ストローク終了</translation>
    </message>
    <message>
        <source>Another bur</source>
        <translation>バー交換</translation>
    </message>
    <message>
        <source>Dentine reached</source>
        <translation>象牙質に到達</translation>
    </message>
    <message>
        <source>Pulp exposed</source>
        <translation>露髄</translation>
    </message>
    <message>
        <source>Adjacent tooth touched</source>
        <translation>隣在歯に接触</translation>
    </message>
    <message>
        <source>Adjacent tooth cut</source>
        <translation>隣在歯を切削</translation>
    </message>
    <message>
        <source>Gingiva cut</source>
        <translation>歯肉損傷</translation>
    </message>
    <message>
        <source>Handpiece on a tooth</source>
        <translation>ハンドピースが歯に接触</translation>
    </message>
    <message>
        <source>Bur stalled</source>
        <translation>バー停止</translation>
    </message>
    <message>
        <source>Pressed too hard</source>
        <translation>押しすぎ</translation>
    </message>
    <message>
        <source>Undo</source>
        <translation>元に戻す</translation>
    </message>
    <message>
        <source>Redo</source>
        <translation>やり直す</translation>
    </message>
    <message>
        <source>Reset</source>
        <translation>初期化</translation>
    </message>
    <message>
        <source>Settings changed</source>
        <translation>設定変更</translation>
    </message>
    <message>
        <source>Fault</source>
        <translation>異常</translation>
    </message>
    <message>
        <source>Gone on with</source>
        <translation>作業の再開</translation>
    </message>
    <message>
        <source>End</source>
        <translation>終了</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::Shelves</name>
    <message>
        <source>File bar</source>
        <translation>ファイルバー</translation>
    </message>
    <message>
        <source>Tool bar</source>
        <translation>ツールバー</translation>
    </message>
    <message>
        <source>File</source>
        <translation>ファイル</translation>
    </message>
    <message>
        <source>Edit</source>
        <translation>編集</translation>
    </message>
    <message>
        <source>View</source>
        <translation>表示</translation>
    </message>
    <message>
        <source>Tools</source>
        <translation>ツール</translation>
    </message>
    <message>
        <source>Sound</source>
        <translation>音</translation>
    </message>
    <message>
        <source>Device</source>
        <translation>デバイス</translation>
    </message>
    <message>
        <source>Help</source>
        <translation>ヘルプ</translation>
    </message>
    <message>
        <source>Panels</source>
        <translation>パネル</translation>
    </message>
    <message>
        <source>Colours of the window</source>
        <translation>ウィンドウの配色</translation>
    </message>
    <message>
        <source>Language</source>
        <translation>言語</translation>
    </message>
    <message>
        <source>Show or hide this bar</source>
        <translation>このバーの表示を切り替えます</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::SoundFeature</name>
    <message>
        <source>Sound</source>
        <translation>音</translation>
    </message>
    <message>
        <source>Mixing ratio of motor and cutting sound</source>
        <translation>モーター音と切削音の割合</translation>
    </message>
    <message>
        <source>Mixing ratio: left the motor alone, right the cutting alone</source>
        <translation>割合：左端はモーター音だけ、右端は切削音だけです</translation>
    </message>
    <message>
        <source>Motor</source>
        <translation>モーター</translation>
    </message>
    <message>
        <source>Cutting</source>
        <translation>切削</translation>
    </message>
    <message>
        <source>Sound of a real handpiece</source>
        <translation>実際のハンドピースの音</translation>
    </message>
    <message>
        <source>Sound (*.wav)</source>
        <translation>音声 (*.wav)</translation>
    </message>
    <message>
        <source>Reading the sound</source>
        <translation>音を読み込んでいます</translation>
    </message>
    <message>
        <source>There is no sound card.</source>
        <translation>サウンドカードがありません。</translation>
    </message>
    <message>
        <source>No sound</source>
        <translation>音を出しません</translation>
    </message>
    <message>
        <source>Muted</source>
        <translation>消音中</translation>
    </message>
    <message>
        <source>Nothing is played: %1</source>
        <translation>音を再生していません：%1</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::StarterFeature</name>
    <message>
        <source>%1 % · %2 faces</source>
        <translation>%1 % · %2 面</translation>
    </message>
    <message>
        <source>Resolution of the tooth</source>
        <translation>歯の解像度</translation>
    </message>
    <message>
        <source>Make the tooth that is open anew with so many faces</source>
        <translation>開いている歯をこの面数で作り直します</translation>
    </message>
    <message>
        <source>A tooth of the program at one of the five resolutions of the paper&apos;s Table II</source>
        <translation>プログラムの歯を、論文の表 II の五つの解像度のいずれかで開きます</translation>
    </message>
    <message>
        <source>Resolution</source>
        <translation>解像度</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ViewFeature</name>
    <message>
        <source>View</source>
        <translation>表示</translation>
    </message>
    <message>
        <source>Views</source>
        <translation>視点</translation>
    </message>
    <message>
        <source>Standard dental views</source>
        <translation>歯科の標準的な視点</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::MeasureBox</name>
    <message>
        <source>Measuring</source>
        <translation>計測</translation>
    </message>
    <message>
        <source>Depth below the surface</source>
        <translation>表面からの深さ</translation>
    </message>
    <message>
        <source>How deep the tip is below the tooth&apos;s first surface</source>
        <translation>切削前の表面から測った、バー先端の深さです</translation>
    </message>
    <message>
        <source>Distance measured</source>
        <translation>測った距離</translation>
    </message>
    <message>
        <source>Between the two points of the calliper</source>
        <translation>ノギスの 2 点間の距離です</translation>
    </message>
    <message>
        <source>Remaining dentine thickness</source>
        <translation>残存象牙質の厚さ</translation>
    </message>
    <message>
        <source>Remaining dentine thickness between the bur and the pulp</source>
        <translation>バーと歯髄の間の残存象牙質の厚さです</translation>
    </message>
    <message>
        <source>Remaining dentine thickness, in words</source>
        <translation>残存象牙質の厚さの目安</translation>
    </message>
    <message>
        <source>This exercise hides the depths.</source>
        <translation>この課題では深さを表示しません。</translation>
    </message>
    <message>
        <source>Calliper</source>
        <translation>ノギス</translation>
    </message>
    <message>
        <source>Click two points on the tooth to measure between them (D)</source>
        <translation>歯の上の 2 点をクリックして距離を測ります（D）</translation>
    </message>
    <message>
        <source>How hard to press</source>
        <translation>押す強さ</translation>
    </message>
    <message>
        <source>How hard the left button presses (Shift and the wheel)</source>
        <translation>左ボタンで押す強さです（Shift とホイール）</translation>
    </message>
    <message>
        <source>Stop at a depth of</source>
        <translation>深さ制限</translation>
    </message>
    <message>
        <source>Depth stop</source>
        <translation>深さ制限</translation>
    </message>
    <message>
        <source>The bur goes no deeper than this (Ctrl and the wheel)</source>
        <translation>バーはこれより深く入りません（Ctrl とホイール）</translation>
    </message>
    <message>
        <source>Depth of the stop</source>
        <translation>制限する深さ</translation>
    </message>
    <message>
        <source> mm</source>
        <translation> mm</translation>
    </message>
    <message>
        <source>Section</source>
        <translation>断面</translation>
    </message>
    <message>
        <source>Cut the tooth open</source>
        <translation>歯を断面で表示する</translation>
    </message>
    <message>
        <source>Cut the tooth open to look inside (X)</source>
        <translation>歯を断面で表示して内部を見ます（X）</translation>
    </message>
    <message>
        <source>Direction of the section</source>
        <translation>断面の方向</translation>
    </message>
    <message>
        <source>Place of the section</source>
        <translation>断面の位置</translation>
    </message>
    <message>
        <source>Place of the section in millimetres</source>
        <translation>断面の位置（ミリメートル）</translation>
    </message>
    <message>
        <source>mm</source>
        <translation>mm</translation>
    </message>
    <message>
        <source>N</source>
        <translation>N</translation>
    </message>
    <message>
        <source>This exercise has no sections.</source>
        <translation>この課題では断面を使えません。</translation>
    </message>
    <message>
        <source>Press</source>
        <translation>押す力</translation>
    </message>
    <message>
        <source>Load</source>
        <translation>荷重</translation>
    </message>
    <message>
        <source>Measure a distance</source>
        <translation>距離を測る</translation>
    </message>
    <message>
        <source>Bucco-lingual</source>
        <translation>頬舌断</translation>
    </message>
    <message>
        <source>Mesio-distal</source>
        <translation>近遠心断</translation>
    </message>
    <message>
        <source>Horizontal</source>
        <translation>水平断</translation>
    </message>
    <message>
        <source>This exercise has no calliper.</source>
        <translation>この課題ではノギスは使えません。</translation>
    </message>
    <message>
        <source>This exercise has no depth stop.</source>
        <translation>この課題では深さ制限は使えません。</translation>
    </message>
    <message>
        <source>Pulp exposed</source>
        <translation>露髄しています</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::MendDialog</name>
    <message>
        <source>Mend the surface</source>
        <translation>表面の修復</translation>
    </message>
    <message>
        <source>Mending %1</source>
        <translation>%1 を修復しています</translation>
    </message>
    <message>
        <source>Progress</source>
        <translation>進捗</translation>
    </message>
    <message>
        <source>Stand it on a flat base</source>
        <translation>平らな基底部を付ける</translation>
    </message>
    <message>
        <source>The longest border gets walls and a floor; other holes are closed as usual</source>
        <translation>最も長い縁に壁と底を付け、ほかの穴は通常どおり閉じます</translation>
    </message>
    <message>
        <source>Save as and open...</source>
        <translation>別名で保存して開く...</translation>
    </message>
    <message>
        <source>The file that was mended stays as it is</source>
        <translation>修復前のファイルはそのまま残ります</translation>
    </message>
    <message>
        <source>This cannot be mended here: %1 %2</source>
        <translation>ここでは修復できません：%1 %2</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::NoticeBar</name>
    <message>
        <source>Message</source>
        <translation>メッセージ</translation>
    </message>
    <message>
        <source>Remedy</source>
        <translation>対処方法</translation>
    </message>
    <message>
        <source>Close the message</source>
        <translation>メッセージを閉じる</translation>
    </message>
    <message numerus="yes">
        <source>%n more</source>
        <translation>
            <numerusform>ほか %n 件</numerusform>
        </translation>
    </message>
    <message>
        <source>Not now</source>
        <translation>後で</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ParameterBox</name>
    <message>
        <source>What the tooth feels like</source>
        <translation>歯の手触り</translation>
    </message>
    <message>
        <source>Reset</source>
        <translation>元の値に戻す</translation>
    </message>
    <message>
        <source>Reset spring, damper and friction</source>
        <translation>ばね、ダンパー、摩擦を元の値に戻す</translation>
    </message>
    <message>
        <source>Back to the tissues&apos; own values (all at 1)</source>
        <translation>組織の元の値に戻します（すべて 1）</translation>
    </message>
    <message>
        <source>Multiplies every tissue&apos;s own value; 1 is the tissue&apos;s own.</source>
        <translation>すべての組織の値に掛ける倍率です。1 で組織の元の値になります。</translation>
    </message>
    <message>
        <source>Each tissue as the hand feels it</source>
        <translation>手に伝わる組織ごとの値</translation>
    </message>
    <message>
        <source>Tissue</source>
        <translation>組織</translation>
    </message>
    <message>
        <source>Spring
[N/mm]</source>
        <translation>ばね
[N/mm]</translation>
    </message>
    <message>
        <source>Damper
[N s/mm]</source>
        <translation>ダンパー
[N s/mm]</translation>
    </message>
    <message>
        <source>Friction</source>
        <translation>摩擦</translation>
    </message>
    <message>
        <source>Stiffness: the tissue&apos;s fraction times the multiplier times the device&apos;s limit</source>
        <translation>剛性：組織の割合 × 倍率 × デバイスの限界</translation>
    </message>
    <message>
        <source>Damping on the approach</source>
        <translation>近づくときの減衰</translation>
    </message>
    <message>
        <source>Coulomb friction of the still bur</source>
        <translation>回転していないバーのクーロン摩擦</translation>
    </message>
    <message>
        <source>Volume a second for load, angular speed and radius; 0: cannot be cut</source>
        <translation>荷重、角速度、半径に対する 1 秒当たりの体積。0 は切削できないことを示します</translation>
    </message>
    <message>
        <source>Contact by</source>
        <translation>接触の計算</translation>
    </message>
    <message>
        <source>Contact method</source>
        <translation>接触の計算方法</translation>
    </message>
    <message>
        <source>Distance field (cuts)</source>
        <translation>距離場（切削できます）</translation>
    </message>
    <message>
        <source>Convex hull, as in the paper (touch only)</source>
        <translation>凸包、論文の方法（触るだけ）</translation>
    </message>
    <message>
        <source>Voxel size</source>
        <translation>ボクセルの大きさ</translation>
    </message>
    <message>
        <source>%1 µm</source>
        <translation>%1 µm</translation>
    </message>
    <message>
        <source>%1 gives at most %2, %3 and %4.</source>
        <translation>%1の限界は %2、%3、%4 です。</translation>
    </message>
    <message>
        <source>The device</source>
        <translation>デバイス</translation>
    </message>
    <message>
        <source>N</source>
        <translation>N</translation>
    </message>
    <message>
        <source>N/mm</source>
        <translation>N/mm</translation>
    </message>
    <message>
        <source>N s/mm</source>
        <translation>N s/mm</translation>
    </message>
    <message>
        <source>Held by the device&apos;s limit: %1 was asked for.</source>
        <translation>デバイスの限界に抑えています。設定値は %1 です。</translation>
    </message>
    <message>
        <source>none</source>
        <translation>なし</translation>
    </message>
    <message>
        <source>▲ Held by the device&apos;s limit: the hand feels no more than that.</source>
        <translation>▲ デバイスの限界に抑えています。これより強くは伝わりません。</translation>
    </message>
    <message>
        <source>All values lie within what the device can give.</source>
        <translation>すべての値がデバイスの限界内です。</translation>
    </message>
    <message>
        <source>Lift the bur first.</source>
        <translation>先にバーを上げてください。</translation>
    </message>
    <message>
        <source>The hull knows only whole teeth: reset the tooth to choose it.</source>
        <translation>凸包は切削前の歯にしか使えません。歯を最初の状態に戻すと選べます。</translation>
    </message>
    <message>
        <source>The hull touches but does not cut.</source>
        <translation>凸包では触れますが、切削はできません。</translation>
    </message>
    <message>
        <source>Changes at once.</source>
        <translation>すぐに変わります。</translation>
    </message>
    <message>
        <source>What you cut will be cut again at the new size; this takes a while and can be cancelled.</source>
        <translation>削った部分を新しい大きさで削り直します。しばらくかかりますが、途中で中止できます。</translation>
    </message>
    <message>
        <source>The tooth is made anew at that size; smaller is finer and slower.</source>
        <translation>その大きさで歯を作り直します。小さいほど細かく、遅くなります。</translation>
    </message>
    <message>
        <source>Hardness</source>
        <translation>硬さ</translation>
    </message>
    <message>
        <source>How hard the tooth feels</source>
        <translation>歯の硬さの感じ方</translation>
    </message>
    <message>
        <source>Cushion</source>
        <translation>弾み</translation>
    </message>
    <message>
        <source>How much the touch is cushioned</source>
        <translation>触れたときの衝撃の和らぎ方</translation>
    </message>
    <message>
        <source>Roughness</source>
        <translation>ざらつき</translation>
    </message>
    <message>
        <source>How rough the surface feels</source>
        <translation>表面のざらつきの感じ方</translation>
    </message>
    <message>
        <source>Spring</source>
        <translation>ばね</translation>
    </message>
    <message>
        <source>Multiplier of every tissue&apos;s stiffness</source>
        <translation>すべての組織の剛性に掛ける倍率</translation>
    </message>
    <message>
        <source>Spring multiplier</source>
        <translation>ばねの倍率</translation>
    </message>
    <message>
        <source>Damper</source>
        <translation>ダンパー</translation>
    </message>
    <message>
        <source>Multiplier of every tissue&apos;s damping</source>
        <translation>すべての組織の減衰に掛ける倍率</translation>
    </message>
    <message>
        <source>Damper multiplier</source>
        <translation>ダンパーの倍率</translation>
    </message>
    <message>
        <source>Multiplier of every tissue&apos;s friction</source>
        <translation>すべての組織の摩擦に掛ける倍率</translation>
    </message>
    <message>
        <source>Friction multiplier</source>
        <translation>摩擦の倍率</translation>
    </message>
    <message>
        <source>Cutting
[µm²/N]</source>
        <translation>切削
[µm²/N]</translation>
    </message>
    <message>
        <source>Force by</source>
        <translation>力の計算</translation>
    </message>
    <message>
        <source>Force model</source>
        <translation>力のモデル</translation>
    </message>
    <message>
        <source>Proxy on the surface</source>
        <translation>表面上のプロキシ</translation>
    </message>
    <message>
        <source>Penalty, as in the paper</source>
        <translation>ペナルティ法(論文どおり)</translation>
    </message>
    <message>
        <source>Spring and damper by the depth alone, without friction; the bur sinks in.</source>
        <translation>ばねとダンパーは深さだけで決まり、摩擦はありません。バーは沈み込みます。</translation>
    </message>
    <message>
        <source>The bur stays on the surface; spring, damper and friction hold the hand to it.</source>
        <translation>バーは表面にとどまり、ばね・ダンパー・摩擦が手をつなぎとめます。</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::PedalMenu</name>
    <message>
        <source>Foot pedal</source>
        <translation>フットペダル</translation>
    </message>
    <message>
        <source>The button alone is the pedal</source>
        <translation>ボタンだけがペダルになります</translation>
    </message>
    <message>
        <source>Beside the button: the one that is pressed harder counts</source>
        <translation>ボタンと併用: 強く踏まれた（押された）ほうが有効です</translation>
    </message>
    <message>
        <source>No foot pedal</source>
        <translation>フットペダルなし</translation>
    </message>
    <message>
        <source>%1: not there</source>
        <translation>%1: 見つかりません</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::PlacingPage</name>
    <message>
        <source>What is the case called?</source>
        <translation>症例の名前</translation>
    </message>
    <message>
        <source>Name of the case</source>
        <translation>症例の名前</translation>
    </message>
    <message>
        <source>Students see it. No patient&apos;s name</source>
        <translation>学生に表示されます。患者の名前は入れないでください</translation>
    </message>
    <message>
        <source>for example: Molar with deep caries</source>
        <translation>例：深いう蝕のある大臼歯</translation>
    </message>
    <message>
        <source>Students see it. It is never taken from the scan: no name of a patient here.</source>
        <translation>学生に表示されます。スキャンから取られることはありません。患者の名前は入れないでください。</translation>
    </message>
    <message>
        <source>Which tooth is it?</source>
        <translation>どの歯ですか</translation>
    </message>
    <message>
        <source>Which way is up?</source>
        <translation>上下の向き</translation>
    </message>
    <message>
        <source>Upside down</source>
        <translation>上下を逆にする</translation>
    </message>
    <message>
        <source>The crown is where the roots are shown</source>
        <translation>歯冠と歯根が逆に表示されている場合</translation>
    </message>
    <message>
        <source>Mesial is on the other side</source>
        <translation>近心を反対側にする</translation>
    </message>
    <message>
        <source>Turn by half about the long axis</source>
        <translation>歯軸の周りに半回転します</translation>
    </message>
    <message>
        <source>Turn 90° left</source>
        <translation>左へ 90°</translation>
    </message>
    <message>
        <source>Seen from above</source>
        <translation>上から見た向き</translation>
    </message>
    <message>
        <source>Turn 90° right</source>
        <translation>右へ 90°</translation>
    </message>
    <message>
        <source>5° left</source>
        <translation>左へ 5°</translation>
    </message>
    <message>
        <source>Turn a little, seen from above</source>
        <translation>上から見て少し回します</translation>
    </message>
    <message>
        <source>5° right</source>
        <translation>右へ 5°</translation>
    </message>
    <message>
        <source>Tip 5° to mesial</source>
        <translation>近心へ 5° 傾ける</translation>
    </message>
    <message>
        <source>The crown goes towards mesial</source>
        <translation>歯冠が近心へ動きます</translation>
    </message>
    <message>
        <source>Tip 5° to distal</source>
        <translation>遠心へ 5° 傾ける</translation>
    </message>
    <message>
        <source>The crown goes towards distal</source>
        <translation>歯冠が遠心へ動きます</translation>
    </message>
    <message>
        <source>Tip 5° to the side</source>
        <translation>横へ 5° 傾ける</translation>
    </message>
    <message>
        <source>The crown goes towards the green arrow</source>
        <translation>歯冠が緑の矢印の側へ動きます</translation>
    </message>
    <message>
        <source>Tip 5° back</source>
        <translation>逆の横へ 5° 傾ける</translation>
    </message>
    <message>
        <source>The crown goes away from the green arrow</source>
        <translation>歯冠が緑の矢印と反対側へ動きます</translation>
    </message>
    <message>
        <source>As the program found it</source>
        <translation>自動の向きに戻す</translation>
    </message>
    <message>
        <source>Forget all turning by hand</source>
        <translation>手動の回転をすべて取り消します</translation>
    </message>
    <message>
        <source>From occlusal</source>
        <translation>咬合面から</translation>
    </message>
    <message>
        <source>From buccal</source>
        <translation>頬側から</translation>
    </message>
    <message>
        <source>From mesial</source>
        <translation>近心から</translation>
    </message>
    <message>
        <source>Oblique</source>
        <translation>斜め</translation>
    </message>
    <message>
        <source>Give the case a name</source>
        <translation>症例に名前を付けてください</translation>
    </message>
    <message>
        <source>Being turned</source>
        <translation>回転中</translation>
    </message>
    <message>
        <source>The blue arrow goes out of the crown, the red one towards the midline of the mouth. Say which tooth it is, and the sides get their names.</source>
        <translation>青い矢印は歯冠の外へ、赤い矢印は正中へ向きます。どの歯かを指定すると、頬側と舌側の名前が付きます。</translation>
    </message>
    <message>
        <source>The blue arrow goes out of the crown, the red one towards the midline of the mouth. Are the sides wrong, then mesial is on the other side, or it is the other side&apos;s tooth.</source>
        <translation>青い矢印は歯冠の外へ、赤い矢印は正中へ向きます。頬側と舌側が逆なら、近心が反対か、反対側の歯です。</translation>
    </message>
    <message>
        <source>Turned by hand.</source>
        <translation>手動で向きを変えました。</translation>
    </message>
    <message>
        <source>The program is sure which way is up.</source>
        <translation>上下の向きは確実です。</translation>
    </message>
    <message>
        <source>The program is fairly sure which way is up: have a look.</source>
        <translation>上下の向きはほぼ確実ですが、確かめてください。</translation>
    </message>
    <message>
        <source>The program guessed which way is up: have a look.</source>
        <translation>上下の向きは推定です。確かめてください。</translation>
    </message>
    <message>
        <source>Which side is mesial is a guess.</source>
        <translation>近心の側は推定です。</translation>
    </message>
    <message>
        <source>Name and placing</source>
        <translation>名前と向き</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::PlotPanel</name>
    <message>
        <source>Plots</source>
        <translation>グラフ</translation>
    </message>
    <message>
        <source>Hold the plots</source>
        <translation>グラフを止める</translation>
    </message>
    <message>
        <source>Hold the plots; what comes is kept</source>
        <translation>グラフの表示を止めます。その間の値も残ります</translation>
    </message>
    <message>
        <source>Save the plots</source>
        <translation>グラフを保存</translation>
    </message>
    <message>
        <source>Drawing (SVG)…</source>
        <translation>図（SVG）…</translation>
    </message>
    <message>
        <source>Picture (PNG)…</source>
        <translation>画像（PNG）…</translation>
    </message>
    <message>
        <source>Table (CSV)…</source>
        <translation>表（CSV）…</translation>
    </message>
    <message>
        <source>Let the plots go on</source>
        <translation>グラフを再開します</translation>
    </message>
    <message>
        <source>Force, depth and rotor speed</source>
        <translation>力、深さ、回転数</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::PlotView</name>
    <message>
        <source>Force, depth and speed of the last 20 seconds</source>
        <translation>直前 20 秒間の力、深さ、回転数</translation>
    </message>
    <message>
        <source>Pressure</source>
        <translation>押す力</translation>
    </message>
    <message>
        <source>Force [N]</source>
        <translation>力 [N]</translation>
    </message>
    <message>
        <source>Depth [mm]</source>
        <translation>深さ [mm]</translation>
    </message>
    <message>
        <source>Speed [1000 rpm]</source>
        <translation>回転数 [1000 rpm]</translation>
    </message>
    <message>
        <source>Rotor speed [1000 rpm]</source>
        <translation>回転数 [1000 rpm]</translation>
    </message>
    <message>
        <source>the device gives no more</source>
        <translation>デバイスの限界</translation>
    </message>
    <message>
        <source>device&apos;s limit %1 N</source>
        <translation>デバイスの限界 %1 N</translation>
    </message>
    <message>
        <source>now</source>
        <translation>現在</translation>
    </message>
    <message>
        <source>%1 s</source>
        <translation>%1 秒</translation>
    </message>
    <message>
        <source>%1 s: depth %2 mm, %3 rpm</source>
        <translation>%1 秒：深さ %2 mm、%3 rpm</translation>
    </message>
    <message>
        <source>%1 s: %2 N, %3 mm, %4 rpm</source>
        <translation>%1 秒：%2 N、%3 mm、%4 rpm</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::PositionClock</name>
    <message>
        <source>Where the operator sits</source>
        <translation>術者の位置</translation>
    </message>
    <message>
        <source>The patient&apos;s head from above, 12 o&apos;clock behind it: left and right arrow go from hour to hour</source>
        <translation>上から見た患者の頭部。頭頂側が 12 時です。左右の矢印キーで隣の時刻に移ります</translation>
    </message>
    <message>
        <source>%1 o&apos;clock</source>
        <translation>%1 時</translation>
    </message>
    <message>
        <source>Sit at %1 o&apos;clock</source>
        <translation>%1 時の位置に座ります</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::PositionFeature</name>
    <message>
        <source>Working position</source>
        <translation>術者の位置</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::PositionPanel</name>
    <message>
        <source>Working position</source>
        <translation>術者の位置</translation>
    </message>
    <message>
        <source>Left-handed</source>
        <translation>左利き</translation>
    </message>
    <message>
        <source>What is usual for a left-handed operator</source>
        <translation>左利きの術者に一般的な位置を示します</translation>
    </message>
    <message>
        <source>Where the head lies is not known: the tooth has no number.</source>
        <translation>歯の番号がないため、頭部の向きが分かりません。</translation>
    </message>
    <message>
        <source>%1 o&apos;clock, by mirror</source>
        <translation>%1 時、ミラー像で</translation>
    </message>
    <message>
        <source>%1 o&apos;clock, seen directly</source>
        <translation>%1 時、直視で</translation>
    </message>
    <message>
        <source>Usual for tooth %1 (habits, no rule):
occlusal: %2
buccal: %3
lingual: %4</source>
        <translation>歯 %1 で一般的な位置（習慣であり、規則ではありません）：
咬合面：%2
頬側：%3
舌側：%4</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ProfileBox</name>
    <message>
        <source>Settings of the device</source>
        <translation>デバイスの設定</translation>
    </message>
    <message>
        <source>Hand</source>
        <translation>手</translation>
    </message>
    <message>
        <source>Which hand holds the stylus: for the left one the head of the handpiece is mirrored</source>
        <translation>スタイラスを持つ手です。左手の場合、ハンドピースのヘッドは左右逆になります</translation>
    </message>
    <message>
        <source>Right</source>
        <translation>右</translation>
    </message>
    <message>
        <source>Left</source>
        <translation>左</translation>
    </message>
    <message>
        <source>Scale</source>
        <translation>倍率</translation>
    </message>
    <message>
        <source>How far the hand goes for a millimetre of the bur. A larger scale is for fine work: the hand is steadier, the tooth feels softer.</source>
        <translation>バーが1 mm動くのに手が動く距離です。大きな倍率は細かな作業向きで、手が安定し、歯は軟らかく感じられます。</translation>
    </message>
    <message>
        <source>%1:1</source>
        <translation>%1:1</translation>
    </message>
    <message>
        <source>Bur</source>
        <translation>バー</translation>
    </message>
    <message>
        <source>The stylus is the handle: the bur sits in the head at an angle, or goes on along the stylus</source>
        <translation>スタイラスが柄です。バーはヘッドに角度をつけて付くか、スタイラスの延長になります</translation>
    </message>
    <message>
        <source>In the head, at its angle</source>
        <translation>ヘッドに角度をつけて</translation>
    </message>
    <message>
        <source>Along the stylus</source>
        <translation>スタイラスの延長に</translation>
    </message>
    <message>
        <source>Clutch</source>
        <translation>クラッチ</translation>
    </message>
    <message>
        <source>While this button is held the bur stays and the hand moves freely, to reach farther</source>
        <translation>このボタンを押している間、バーは止まり、手だけを動かせます。遠くに届かせるためです</translation>
    </message>
    <message>
        <source>No clutch</source>
        <translation>クラッチなし</translation>
    </message>
    <message>
        <source>Lower button</source>
        <translation>下のボタン</translation>
    </message>
    <message>
        <source>Button %1</source>
        <translation>ボタン %1</translation>
    </message>
    <message>
        <source>Place the tooth here</source>
        <translation>歯をここに置く</translation>
    </message>
    <message>
        <source>Where the hand is now, it has the bur over the tooth from now on</source>
        <translation>いまの手の位置が、これからバーが歯の上にある位置になります</translation>
    </message>
    <message>
        <source>Placing</source>
        <translation>配置</translation>
    </message>
    <message>
        <source>Force</source>
        <translation>力</translation>
    </message>
    <message>
        <source>All forces times this; the device&apos;s limits stay. Below 100 % everything feels softer and the motors stay cooler.</source>
        <translation>すべての力にかける倍率です。デバイスの限界は変わりません。100 % より小さくすると、全体が軟らかく感じられ、モーターも熱くなりにくくなります。</translation>
    </message>
    <message>
        <source> %</source>
        <translation> %</translation>
    </message>
    <message>
        <source>Passivity controller</source>
        <translation>受動性の制御</translation>
    </message>
    <message>
        <source>Takes out energy that the tooth did not give, so that the stylus never buzzes or kicks</source>
        <translation>歯から来ていないエネルギーを取り除き、スタイラスが震えたり跳ねたりしないようにします</translation>
    </message>
    <message>
        <source>Friction compensation</source>
        <translation>摩擦の補償</translation>
    </message>
    <message>
        <source>Gives back part of what the arm&apos;s own joints rub away, so that light touches are felt</source>
        <translation>アームの関節の摩擦で失われる力の一部を補い、軽い接触も感じられるようにします</translation>
    </message>
    <message>
        <source>Thermal budget</source>
        <translation>熱の予算</translation>
    </message>
    <message>
        <source>Lowers the force slowly when one presses hard for long, before the motors get too warm</source>
        <translation>強く長く押したとき、モーターが熱くなりすぎる前に力をゆっくり下げます</translation>
    </message>
    <message>
        <source>Crisp contact</source>
        <translation>硬い接触</translation>
    </message>
    <message>
        <source>A short knock at each touch, at the tissue&apos;s own pitch: makes a soft arm&apos;s enamel feel hard</source>
        <translation>触れるたびに組織に応じた高さの短い衝撃を加え、力の弱いアームでもエナメル質を硬く感じさせます</translation>
    </message>
    <message>
        <source>Cutting vibration</source>
        <translation>切削の振動</translation>
    </message>
    <message>
        <source>The hum of the bur in the hand while it cuts, 100 to 400 Hz</source>
        <translation>切削中に手に伝わるバーの振動です（100〜400 Hz）</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ReachPicture</name>
    <message>
        <source>The stylus in the device&apos;s reach</source>
        <translation>デバイスの届く範囲とスタイラス</translation>
    </message>
    <message>
        <source>The stylus in the device&apos;s reach: from the front on the left, from above on the right</source>
        <translation>デバイスの届く範囲とスタイラス：左は正面、右は上から</translation>
    </message>
    <message>
        <source>From the front</source>
        <translation>正面から</translation>
    </message>
    <message>
        <source>From above</source>
        <translation>上から</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ReplayBar</name>
    <message>
        <source>Replay</source>
        <translation>再生</translation>
    </message>
    <message>
        <source>Stroke before</source>
        <translation>前のストローク</translation>
    </message>
    <message>
        <source>To the stroke before</source>
        <translation>前のストロークへ</translation>
    </message>
    <message>
        <source>Play</source>
        <translation>再生</translation>
    </message>
    <message>
        <source>Play or pause</source>
        <translation>再生・一時停止</translation>
    </message>
    <message>
        <source>Next stroke</source>
        <translation>次のストローク</translation>
    </message>
    <message>
        <source>To the next stroke</source>
        <translation>次のストロークへ</translation>
    </message>
    <message>
        <source>Time and length</source>
        <translation>時刻と長さ</translation>
    </message>
    <message>
        <source>Speed of the replay</source>
        <translation>再生の速さ</translation>
    </message>
    <message>
        <source>× %1</source>
        <translation>× %1</translation>
    </message>
    <message>
        <source>End the replay</source>
        <translation>再生を終える</translation>
    </message>
    <message>
        <source>Pause</source>
        <translation>一時停止</translation>
    </message>
    <message>
        <source>%1 / %2</source>
        <translation>%1 / %2</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ReportPage</name>
    <message>
        <source>Report of the case</source>
        <translation>症例のレポート</translation>
    </message>
    <message>
        <source>Save the case as</source>
        <translation>症例の保存先</translation>
    </message>
    <message>
        <source>A file that ends in .handpiece, or a folder</source>
        <translation>.handpiece で終わるファイル、またはフォルダー</translation>
    </message>
    <message>
        <source>Where...</source>
        <translation>参照...</translation>
    </message>
    <message>
        <source>Choose where the case is saved</source>
        <translation>症例の保存先を選びます</translation>
    </message>
    <message>
        <source>Save the case</source>
        <translation>症例を保存</translation>
    </message>
    <message>
        <source>Try it now</source>
        <translation>すぐに試す</translation>
    </message>
    <message>
        <source>Save the case and open it in the simulator</source>
        <translation>症例を保存して、シミュレーターで開きます</translation>
    </message>
    <message>
        <source>Cases (*.handpiece);;All files (*)</source>
        <translation>症例 (*.handpiece);;すべてのファイル (*)</translation>
    </message>
    <message>
        <source>Saved: %1</source>
        <translation>保存しました：%1</translation>
    </message>
    <message>
        <source>Open the report</source>
        <translation>レポートを開く</translation>
    </message>
    <message>
        <source>The page to print that was saved with the case, with its pictures</source>
        <translation>症例とともに保存された、画像入りの印刷用ページ</translation>
    </message>
    <message>
        <source>Preview</source>
        <translation>プレビュー</translation>
    </message>
    <message>
        <source>The case is being made in full. The report comes with it.</source>
        <translation>症例を作成しています。出来上がるとレポートが表示されます。</translation>
    </message>
    <message>
        <source>The case is not made yet.</source>
        <translation>症例はまだ作られていません。</translation>
    </message>
    <message>
        <source>mm</source>
        <translation>mm</translation>
    </message>
    <message>
        <source>Volumes</source>
        <translation>体積</translation>
    </message>
    <message>
        <source>%1 mm³</source>
        <translation>%1 mm³</translation>
    </message>
    <message>
        <source>with an authored lesion</source>
        <translation>作成された病変を含む</translation>
    </message>
    <message>
        <source>%1 %</source>
        <translation>%1 %</translation>
    </message>
    <message>
        <source>Together</source>
        <translation>合計</translation>
    </message>
    <message>
        <source>Sizes</source>
        <translation>寸法</translation>
    </message>
    <message>
        <source>Mesiodistal × buccolingual × length</source>
        <translation>近遠心 × 頬舌 × 長さ</translation>
    </message>
    <message>
        <source>%1 × %2 × %3 mm</source>
        <translation>%1 × %2 × %3 mm</translation>
    </message>
    <message>
        <source>Enamel over dentine</source>
        <translation>象牙質を覆うエナメル質</translation>
    </message>
    <message>
        <source>%1 in the middle</source>
        <translation>中央値 %1</translation>
    </message>
    <message>
        <source>at most %1</source>
        <translation>最大 %1</translation>
    </message>
    <message>
        <source>Dentine over the pulp, in the crown</source>
        <translation>歯冠部の歯髄を覆う厚さ</translation>
    </message>
    <message>
        <source>at least %1</source>
        <translation>最小 %1</translation>
    </message>
    <message>
        <source>How good it is</source>
        <translation>出来ばえ</translation>
    </message>
    <message>
        <source>Voxels of the scan</source>
        <translation>スキャンのボクセル</translation>
    </message>
    <message>
        <source>given by hand</source>
        <translation>手動で入力</translation>
    </message>
    <message>
        <source>Blur of the scan</source>
        <translation>スキャンのぼけ</translation>
    </message>
    <message>
        <source>standard deviation</source>
        <translation>標準偏差</translation>
    </message>
    <message>
        <source>Enamel stands out of dentine by</source>
        <translation>エナメル質と象牙質の差</translation>
    </message>
    <message>
        <source>%1 × the noise</source>
        <translation>ノイズの %1 倍</translation>
    </message>
    <message>
        <source>little: look at their border in the slices</source>
        <translation>差が小さいので、境目をスライスで確かめてください</translation>
    </message>
    <message>
        <source>Thresholds</source>
        <translation>しきい値</translation>
    </message>
    <message>
        <source>set by hand</source>
        <translation>手動で設定</translation>
    </message>
    <message>
        <source>found by the program</source>
        <translation>自動で決定</translation>
    </message>
    <message>
        <source>Intraoral scan</source>
        <translation>口腔内スキャン</translation>
    </message>
    <message>
        <source>rms %1</source>
        <translation>二乗平均 %1</translation>
    </message>
    <message>
        <source>95 % within %1</source>
        <translation>95 % が %1 以内</translation>
    </message>
    <message>
        <source>Faces</source>
        <translation>面の数</translation>
    </message>
    <message>
        <source>reduced by at most %1</source>
        <translation>簡略化による誤差は最大 %1</translation>
    </message>
    <message>
        <source>as made from the scan</source>
        <translation>スキャンから作ったまま</translation>
    </message>
    <message>
        <source>Surfaces closed and nested</source>
        <translation>閉じて入れ子になった表面</translation>
    </message>
    <message>
        <source>yes</source>
        <translation>はい</translation>
    </message>
    <message>
        <source>no</source>
        <translation>いいえ</translation>
    </message>
    <message>
        <source>it can be cut</source>
        <translation>切削できます</translation>
    </message>
    <message>
        <source>findings: %1</source>
        <translation>指摘 %1 件</translation>
    </message>
    <message>
        <source>To know</source>
        <translation>知っておくこと</translation>
    </message>
    <message>
        <source>What the scan cannot show</source>
        <translation>スキャンに写らないもの</translation>
    </message>
    <message>
        <source>Anything thinner than about %1: hairline cracks, narrow canals, the thin edge of the enamel.</source>
        <translation>およそ %1 より薄いもの：微小な亀裂、細い根管、エナメル質の薄い縁。</translation>
    </message>
    <message>
        <source>Cementum: it is taken for dentine. Gingiva and periodontal ligament: X-rays pass them.</source>
        <translation>セメント質：象牙質として扱われます。歯肉と歯根膜：X 線が透過します。</translation>
    </message>
    <message>
        <source>Early caries: only what has lost enough mineral is darker. How soft it is, is not seen at all.</source>
        <translation>初期う蝕：ミネラルが十分に失われた部分だけが暗く写ります。軟らかさはまったく写りません。</translation>
    </message>
    <message>
        <source>The authored lesion is the teacher&apos;s: no patient had it.</source>
        <translation>作成された病変は教員によるもので、患者にはありません。</translation>
    </message>
    <message>
        <source>Report and finish</source>
        <translation>レポートと完了</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ScanModel</name>
    <message>
        <source>Looking what is there</source>
        <translation>内容を調べています</translation>
    </message>
    <message>
        <source>Reading the slices</source>
        <translation>スライスを読み込んでいます</translation>
    </message>
    <message>
        <source>Measuring the tooth</source>
        <translation>歯を測っています</translation>
    </message>
    <message>
        <source>Writing the case</source>
        <translation>症例を書き出しています</translation>
    </message>
    <message>
        <source>Drawing the report</source>
        <translation>レポートを描いています</translation>
    </message>
    <message>
        <source>Finding the tissues</source>
        <translation>組織を見分けています</translation>
    </message>
    <message>
        <source>Making surfaces</source>
        <translation>表面を作っています</translation>
    </message>
    <message>
        <source>Finding which way is up</source>
        <translation>向きを調べています</translation>
    </message>
    <message>
        <source>Reducing the faces</source>
        <translation>面の数を減らしています</translation>
    </message>
    <message>
        <source>Checking the case</source>
        <translation>症例を確認しています</translation>
    </message>
    <message>
        <source>Preview: %1</source>
        <translation>プレビュー：%1</translation>
    </message>
    <message>
        <source>In full: %1</source>
        <translation>本番：%1</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ScanWizard</name>
    <message>
        <source>New case from scan</source>
        <translation>スキャンから新しい症例</translation>
    </message>
    <message>
        <source>Steps</source>
        <translation>手順</translation>
    </message>
    <message>
        <source>The five steps; those that can be gone to</source>
        <translation>5 つの手順。選べるものに移動できます</translation>
    </message>
    <message>
        <source>Go on with the unfinished scan?</source>
        <translation>途中のスキャンを続けますか？</translation>
    </message>
    <message>
        <source>Go on</source>
        <translation>続ける</translation>
    </message>
    <message>
        <source>Go on with the unfinished scan</source>
        <translation>途中のスキャンを続ける</translation>
    </message>
    <message>
        <source>With all that was decided when it was closed</source>
        <translation>閉じたときに決めてあった内容から続けます</translation>
    </message>
    <message>
        <source>Start anew</source>
        <translation>最初から始める</translation>
    </message>
    <message>
        <source>Forget what was decided</source>
        <translation>決めた内容を破棄します</translation>
    </message>
    <message>
        <source>Progress</source>
        <translation>進み具合</translation>
    </message>
    <message>
        <source>How far it is</source>
        <translation>どこまで進んだかを示します</translation>
    </message>
    <message>
        <source>Stop</source>
        <translation>中止</translation>
    </message>
    <message>
        <source>Stop this work; nothing decided is lost</source>
        <translation>この処理を中止します。決めた内容は失われません</translation>
    </message>
    <message>
        <source>Begin the work again that was stopped</source>
        <translation>中止した処理をもう一度始めます</translation>
    </message>
    <message>
        <source>Undo</source>
        <translation>元に戻す</translation>
    </message>
    <message>
        <source>Take the last decision back (Ctrl+Z)</source>
        <translation>最後の決定を取り消します（Ctrl+Z）</translation>
    </message>
    <message>
        <source>Redo</source>
        <translation>やり直す</translation>
    </message>
    <message>
        <source>Decide it again (Ctrl+Shift+Z)</source>
        <translation>取り消した決定をやり直します（Ctrl+Shift+Z）</translation>
    </message>
    <message>
        <source>Save the steps...</source>
        <translation>手順を保存...</translation>
    </message>
    <message>
        <source>Save the steps</source>
        <translation>手順を保存</translation>
    </message>
    <message>
        <source>All decisions as a file; &quot;handpiece scan case --job FILE&quot; makes the same case of it</source>
        <translation>すべての決定をファイルに保存します。「handpiece scan case --job FILE」で同じ症例を作れます</translation>
    </message>
    <message>
        <source>Back</source>
        <translation>戻る</translation>
    </message>
    <message>
        <source>To the step before</source>
        <translation>前の手順へ</translation>
    </message>
    <message>
        <source>Next</source>
        <translation>次へ</translation>
    </message>
    <message>
        <source>To the next step</source>
        <translation>次の手順へ</translation>
    </message>
    <message>
        <source>Close</source>
        <translation>閉じる</translation>
    </message>
    <message>
        <source>What was decided is kept; the next time you can go on with it</source>
        <translation>決めた内容は残り、次回に続けられます</translation>
    </message>
    <message>
        <source>Finish</source>
        <translation>完了</translation>
    </message>
    <message>
        <source>Stopped</source>
        <translation>中止しました</translation>
    </message>
    <message>
        <source>Steps (*.toml)</source>
        <translation>手順 (*.toml)</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::SectionBar</name>
    <message>
        <source>Cut the tooth open in this direction</source>
        <translation>この方向の断面で歯を表示します</translation>
    </message>
    <message>
        <source>Place of the section</source>
        <translation>断面の位置</translation>
    </message>
    <message>
        <source>Where the section lies, from the middle of the tooth&apos;s frame</source>
        <translation>歯の座標の原点から測った断面の位置です</translation>
    </message>
    <message>
        <source> mm</source>
        <translation> mm</translation>
    </message>
    <message>
        <source>Other side</source>
        <translation>反対側</translation>
    </message>
    <message>
        <source>Take the other side away</source>
        <translation>反対側を取り除いて表示します</translation>
    </message>
    <message>
        <source>Close the section</source>
        <translation>断面を閉じる</translation>
    </message>
    <message>
        <source>Show the whole tooth again</source>
        <translation>歯全体の表示に戻します</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::Simulator</name>
    <message>
        <source>switched off</source>
        <translation>オフ</translation>
    </message>
    <message>
        <source>Preparing the tooth</source>
        <translation>歯を準備しています</translation>
    </message>
    <message>
        <source>Reading %1</source>
        <translation>%1 を読み込んでいます</translation>
    </message>
    <message>
        <source>Opening %1</source>
        <translation>%1 を開いています</translation>
    </message>
    <message>
        <source>Bringing the tooth back</source>
        <translation>歯を復元しています</translation>
    </message>
    <message>
        <source>Saving</source>
        <translation>保存しています</translation>
    </message>
    <message>
        <source>Writing the STL file</source>
        <translation>STL ファイルを書き出しています</translation>
    </message>
    <message>
        <source>Writing the report</source>
        <translation>レポートを書き出しています</translation>
    </message>
    <message>
        <source>Copying the recording</source>
        <translation>記録をコピーしています</translation>
    </message>
    <message>
        <source>Cutting the tooth again</source>
        <translation>歯を削り直しています</translation>
    </message>
    <message>
        <source>Reading the sound</source>
        <translation>音を読み込んでいます</translation>
    </message>
    <message>
        <source>reading</source>
        <translation>読み込み中</translation>
    </message>
    <message>
        <source>cutting again what was recorded</source>
        <translation>記録された切削を再現しています</translation>
    </message>
    <message>
        <source>shaping it (the first time only)</source>
        <translation>形を作っています(初回のみ)</translation>
    </message>
    <message>
        <source>measuring distances</source>
        <translation>距離を計算しています</translation>
    </message>
    <message>
        <source>laying out its tissues</source>
        <translation>組織を配置しています</translation>
    </message>
    <message>
        <source>drawing its surface</source>
        <translation>表面を描いています</translation>
    </message>
    <message>
        <source>Writing the tissues</source>
        <translation>組織を書き出しています</translation>
    </message>
    <message>
        <source>Handing in</source>
        <translation>提出しています</translation>
    </message>
    <message>
        <source>Mouse</source>
        <translation>マウス</translation>
    </message>
    <message>
        <source>Simulated device</source>
        <translation>模擬デバイス</translation>
    </message>
    <message>
        <source>making the mouth around it (the first time only)</source>
        <translation>周りの口腔を作成中（初回のみ）</translation>
    </message>
    <message>
        <source>Preparing the exercise</source>
        <translation>課題を準備しています</translation>
    </message>
    <message>
        <source>Scoring your work</source>
        <translation>作業を採点しています</translation>
    </message>
    <message>
        <source>Preparing the exam</source>
        <translation>試験を準備中</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::SliceView</name>
    <message>
        <source>Slice across (axial)</source>
        <translation>水平断のスライス</translation>
    </message>
    <message>
        <source>Slice along, from the front (coronal)</source>
        <translation>前から見た縦のスライス（冠状断）</translation>
    </message>
    <message>
        <source>Slice along, from the side (sagittal)</source>
        <translation>横から見た縦のスライス（矢状断）</translation>
    </message>
    <message>
        <source>Wheel: through the slices. Ctrl and wheel: nearer. Right button: brightness and contrast. Middle button: shift. Double click: all of the slice.</source>
        <translation>ホイール：スライス送り。Ctrl + ホイール：拡大。右ボタン：明るさとコントラスト。中ボタン：移動。ダブルクリック：全体表示。</translation>
    </message>
    <message>
        <source>slice %1 of %2</source>
        <translation>スライス %1 / %2</translation>
    </message>
    <message>
        <source>Axial</source>
        <translation>水平断</translation>
    </message>
    <message>
        <source>Coronal</source>
        <translation>冠状断</translation>
    </message>
    <message>
        <source>Sagittal</source>
        <translation>矢状断</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::SolidView</name>
    <message>
        <source>The tooth, to be turned</source>
        <translation>回転できる歯</translation>
    </message>
    <message>
        <source>Drag: turn. Right button: shift. Wheel: nearer. Double click: all of it. Arrow keys turn.</source>
        <translation>ドラッグ：回転。右ボタン：移動。ホイール：拡大。ダブルクリック：全体表示。矢印キーでも回せます。</translation>
    </message>
    <message>
        <source>Show or hide this tissue</source>
        <translation>この組織を表示または非表示にします</translation>
    </message>
    <message>
        <source>Buccal</source>
        <translation>頬側</translation>
    </message>
    <message>
        <source>Lingual</source>
        <translation>舌側</translation>
    </message>
    <message>
        <source>Occlusal</source>
        <translation>咬合面</translation>
    </message>
    <message>
        <source>Mesial</source>
        <translation>近心</translation>
    </message>
    <message>
        <source>side</source>
        <translation>横</translation>
    </message>
    <message>
        <source>The tooth appears here when its tissues are found</source>
        <translation>組織が見つかると、ここに歯が表示されます</translation>
    </message>
    <message>
        <source>There is no picture. Technical detail: %1</source>
        <translation>画像を表示できません。技術情報：%1</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::SoundControl</name>
    <message>
        <source>Too loud</source>
        <translation>大きすぎます</translation>
    </message>
    <message>
        <source>Level %1 %</source>
        <translation>音量 %1 %</translation>
    </message>
    <message>
        <source>Good</source>
        <translation>適正</translation>
    </message>
    <message>
        <source>Quiet</source>
        <translation>小さい</translation>
    </message>
    <message>
        <source>%1 %</source>
        <translation>%1 %</translation>
    </message>
    <message>
        <source>Sound</source>
        <translation>音</translation>
    </message>
    <message>
        <source>Mute</source>
        <translation>消音</translation>
    </message>
    <message>
        <source>Sound off</source>
        <translation>音を消す</translation>
    </message>
    <message>
        <source>Motor</source>
        <translation>モーター</translation>
    </message>
    <message>
        <source>Loudness of the motor</source>
        <translation>モーター音の大きさ</translation>
    </message>
    <message>
        <source>Cutting</source>
        <translation>切削</translation>
    </message>
    <message>
        <source>Loudness of the cutting</source>
        <translation>切削音の大きさ</translation>
    </message>
    <message>
        <source>Mixture</source>
        <translation>割合</translation>
    </message>
    <message>
        <source>motor</source>
        <translation>モーター</translation>
    </message>
    <message>
        <source>cutting</source>
        <translation>切削</translation>
    </message>
    <message>
        <source>Mixture of motor and cutting</source>
        <translation>モーター音と切削音の割合</translation>
    </message>
    <message>
        <source>Mixture: left the motor alone, right the cutting alone</source>
        <translation>割合：左端はモーター音だけ、右端は切削音だけです</translation>
    </message>
    <message>
        <source>Where the sound comes from</source>
        <translation>音の種類</translation>
    </message>
    <message>
        <source>Level of the microphone</source>
        <translation>マイクの音量</translation>
    </message>
    <message>
        <source>Sound on</source>
        <translation>音を出す</translation>
    </message>
    <message>
        <source>Source of the motor&apos;s sound</source>
        <translation>モーター音の種類</translation>
    </message>
    <message>
        <source>Source of the cutting&apos;s sound</source>
        <translation>切削音の種類</translation>
    </message>
    <message>
        <source>Computed</source>
        <translation>合成音</translation>
    </message>
    <message>
        <source>Recording from a file…</source>
        <translation>ファイルの録音…</translation>
    </message>
    <message>
        <source>Record with the microphone</source>
        <translation>マイクで録音</translation>
    </message>
    <message>
        <source>Record the motor</source>
        <translation>モーター音を録音</translation>
    </message>
    <message>
        <source>Record the cutting</source>
        <translation>切削音を録音</translation>
    </message>
    <message>
        <source>Record what the microphone hears; click again to end</source>
        <translation>マイクの音を録音します。もう一度クリックすると終わります</translation>
    </message>
    <message>
        <source>End recording</source>
        <translation>録音を終える</translation>
    </message>
    <message>
        <source>Record</source>
        <translation>録音</translation>
    </message>
    <message>
        <source>No sound card was found: everything else works.</source>
        <translation>サウンドカードが見つかりません。ほかの機能は使えます。</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::SpeedDial</name>
    <message>
        <source>Speed of the bur now</source>
        <translation>現在のバーの回転数</translation>
    </message>
    <message>
        <source>Speed of the bur now. The mark on the rim is the speed that is set.</source>
        <translation>現在のバーの回転数です。縁の印は設定回転数を示します。</translation>
    </message>
    <message>
        <source>%1 rpm</source>
        <translation>%1 rpm</translation>
    </message>
    <message>
        <source>rpm</source>
        <translation>rpm</translation>
    </message>
    <message>
        <source>× 1000</source>
        <translation>× 1000</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::StatusLine</name>
    <message>
        <source>Status</source>
        <translation>状態</translation>
    </message>
    <message>
        <source>How the simulator is doing</source>
        <translation>シミュレーターの状態です</translation>
    </message>
    <message>
        <source>Record of the session</source>
        <translation>実習の記録</translation>
    </message>
    <message>
        <source>Everything you do is recorded</source>
        <translation>操作はすべて記録されます</translation>
    </message>
    <message>
        <source>Device</source>
        <translation>デバイス</translation>
    </message>
    <message>
        <source>What holds the handpiece</source>
        <translation>ハンドピースを動かす装置です</translation>
    </message>
    <message>
        <source>Tick rate</source>
        <translation>更新頻度</translation>
    </message>
    <message>
        <source>Ticks of the force loop a second</source>
        <translation>力の計算の 1 秒当たりの回数です</translation>
    </message>
    <message>
        <source>Late ticks</source>
        <translation>遅れ</translation>
    </message>
    <message>
        <source>Ticks that began late, and periods that were missed altogether</source>
        <translation>開始が遅れた回数と、抜けた周期の数です</translation>
    </message>
    <message>
        <source>Load</source>
        <translation>負荷</translation>
    </message>
    <message>
        <source>Share of each period that the force loop works</source>
        <translation>1 周期のうち力の計算が占める割合です</translation>
    </message>
    <message>
        <source>One moment</source>
        <translation>お待ちください</translation>
    </message>
    <message>
        <source>Not recording</source>
        <translation>記録していません</translation>
    </message>
    <message>
        <source>Late</source>
        <translation>遅れています</translation>
    </message>
    <message>
        <source>Recording</source>
        <translation>記録中</translation>
    </message>
    <message>
        <source>Ready</source>
        <translation>準備完了</translation>
    </message>
    <message>
        <source>The computer is too busy: what the hand feels may come late. Close other programs.</source>
        <translation>コンピューターの負荷が高く、手に伝わる力が遅れることがあります。ほかのプログラムを閉じてください。</translation>
    </message>
    <message>
        <source>Recording stopped</source>
        <translation>記録が止まりました</translation>
    </message>
    <message>
        <source>No device</source>
        <translation>デバイスなし</translation>
    </message>
    <message>
        <source>%1 Hz</source>
        <translation>%1 Hz</translation>
    </message>
    <message>
        <source>%1 late, %2 missed</source>
        <translation>遅れ %1、抜け %2</translation>
    </message>
    <message>
        <source>%1 late</source>
        <translation>遅れ %1</translation>
    </message>
    <message>
        <source>load %1 %</source>
        <translation>負荷 %1 %</translation>
    </message>
    <message>
        <source>%1: %2</source>
        <translation>%1：%2</translation>
    </message>
    <message>
        <source>%1, %2 Hz</source>
        <translation>%1、毎秒 %2 回</translation>
    </message>
    <message>
        <source>What holds the handpiece, and how often its own servo answers. Press to choose.</source>
        <translation>ハンドピースを動かす装置と、そのサーボの頻度です。押すと選べます。</translation>
    </message>
    <message>
        <source>The device gives no force: %1</source>
        <translation>デバイスは力を出していません：%1</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::SurfacePage</name>
    <message>
        <source>How fine?</source>
        <translation>細かさ</translation>
    </message>
    <message>
        <source>More faces show more and draw slower. What is cut is as fine either way: the simulator cuts voxels of its own.</source>
        <translation>面が多いほど細かく表示され、描画は遅くなります。切削の細かさは変わりません。シミュレーターは独自のボクセルを削ります。</translation>
    </message>
    <message>
        <source>Faces</source>
        <translation>面の数</translation>
    </message>
    <message>
        <source>A share of the faces of the scan itself</source>
        <translation>スキャンから作られた面に対する割合</translation>
    </message>
    <message>
        <source>As many as can be felt</source>
        <translation>触れて分かる細かさまで</translation>
    </message>
    <message>
        <source>All of the scan&apos;s (100 %)</source>
        <translation>スキャンのすべて（100 %）</translation>
    </message>
    <message>
        <source>%1 % of them</source>
        <translation>その %1 %</translation>
    </message>
    <message>
        <source>Five cases: 6, 12, 25, 50, 100 %</source>
        <translation>5 つの症例：6、12、25、50、100 %</translation>
    </message>
    <message>
        <source>A number of faces</source>
        <translation>面の数を指定</translation>
    </message>
    <message>
        <source>Number of faces</source>
        <translation>面の数</translation>
    </message>
    <message>
        <source>Of all surfaces together</source>
        <translation>すべての表面の合計</translation>
    </message>
    <message>
        <source>Grid of the tissues</source>
        <translation>組織の格子</translation>
    </message>
    <message>
        <source>How close the points lie at which the tissues are told; finer than the scan shows nothing more</source>
        <translation>組織を判定する点の間隔。スキャンより細かくしても情報は増えません</translation>
    </message>
    <message>
        <source> mm</source>
        <translation> mm</translation>
    </message>
    <message>
        <source>as the scan</source>
        <translation>スキャンと同じ</translation>
    </message>
    <message>
        <source>Smooth (volumes are kept)</source>
        <translation>滑らかにする（体積は保たれます）</translation>
    </message>
    <message>
        <source>Smooth</source>
        <translation>滑らかにする</translation>
    </message>
    <message>
        <source>Takes away the steps of voxels without shrinking the tooth</source>
        <translation>歯を縮めずにボクセルの段差を取り除きます</translation>
    </message>
    <message>
        <source>Adjacent teeth and bone around it, to look at</source>
        <translation>隣在歯と骨も表示する</translation>
    </message>
    <message>
        <source>Adjacent teeth and bone around it</source>
        <translation>隣在歯と周囲の骨</translation>
    </message>
    <message>
        <source>What stands around the tooth in the scan</source>
        <translation>スキャンで歯の周りにあるもの</translation>
    </message>
    <message>
        <source>A scan from the mouth</source>
        <translation>口腔内スキャン</translation>
    </message>
    <message>
        <source>An intraoral scan (STL, PLY, OBJ) is finer than a CT. It is laid onto the tooth and becomes its outside where the two agree.</source>
        <translation>口腔内スキャン（STL、PLY、OBJ）は CT より精細です。歯に重ね合わせ、一致する場所では外側の表面になります。</translation>
    </message>
    <message>
        <source>Choose...</source>
        <translation>選ぶ...</translation>
    </message>
    <message>
        <source>Choose an intraoral scan</source>
        <translation>口腔内スキャンを選びます</translation>
    </message>
    <message>
        <source>Without</source>
        <translation>使わない</translation>
    </message>
    <message>
        <source>Without an intraoral scan</source>
        <translation>口腔内スキャンを使いません</translation>
    </message>
    <message>
        <source>Taken where they agree within</source>
        <translation>採用する差の範囲</translation>
    </message>
    <message>
        <source>An intraoral scan</source>
        <translation>口腔内スキャン</translation>
    </message>
    <message>
        <source>Surfaces (*.stl *.ply *.obj);;All files (*)</source>
        <translation>曲面 (*.stl *.ply *.obj);;すべてのファイル (*)</translation>
    </message>
    <message>
        <source>No tooth was found yet</source>
        <translation>まだ歯が見つかっていません</translation>
    </message>
    <message>
        <source>None</source>
        <translation>なし</translation>
    </message>
    <message>
        <source>As it will be</source>
        <translation>出来上がり</translation>
    </message>
    <message>
        <source>Preview; the fine surfaces are being made</source>
        <translation>プレビュー：細かい表面を作成中</translation>
    </message>
    <message>
        <source>Preview; the fine surfaces were not made</source>
        <translation>プレビュー：細かい表面は未作成</translation>
    </message>
    <message>
        <source>It lies on the tooth to %1 mm (rms; 95 % within %2 mm), %3 % of it has a counterpart.</source>
        <translation>歯との差は %1 mm（二乗平均、95 % が %2 mm 以内）、%3 % が対応しています。</translation>
    </message>
    <message>
        <source>%1 %</source>
        <translation>%1 %</translation>
    </message>
    <message>
        <source>%1 faces</source>
        <translation>%1 面</translation>
    </message>
    <message>
        <source>reduced by at most %1 mm</source>
        <translation>簡略化による誤差は最大 %1 mm</translation>
    </message>
    <message>
        <source>encloses %1 mm³</source>
        <translation>内部の体積 %1 mm³</translation>
    </message>
    <message>
        <source>Whole tooth</source>
        <translation>歯全体</translation>
    </message>
    <message>
        <source>%1, authored</source>
        <translation>%1（作成）</translation>
    </message>
    <message>
        <source>Surfaces</source>
        <translation>表面</translation>
    </message>
    <message>
        <source>These are many faces: it will be slow to open and to draw. Take a smaller share of them.</source>
        <translation>面の数が多く、開くのも描画も遅くなります。割合を小さくしてください。</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::Timeline</name>
    <message>
        <source>Time of the replay</source>
        <translation>再生の時刻</translation>
    </message>
    <message>
        <source>%1 of %2</source>
        <translation>%1 / %2</translation>
    </message>
    <message numerus="yes">
        <source>and %n more</source>
        <translation>
            <numerusform>ほか %n 件</numerusform>
        </translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::TissuePage</name>
    <message>
        <source>mm</source>
        <translation>mm</translation>
    </message>
    <message>
        <source>This tooth, by a click</source>
        <translation>この歯（クリックで指定）</translation>
    </message>
    <message>
        <source>Nothing here</source>
        <translation>何もない</translation>
    </message>
    <message>
        <source>Brush: %1, %2</source>
        <translation>ブラシ：%1、%2</translation>
    </message>
    <message>
        <source>Cut off, plane %1</source>
        <translation>切り離し：平面 %1</translation>
    </message>
    <message>
        <source>Lesion, authored, %1</source>
        <translation>作成された病変、%1</translation>
    </message>
    <message>
        <source>Preview</source>
        <translation>プレビュー</translation>
    </message>
    <message>
        <source>Preview, being renewed</source>
        <translation>プレビュー（更新中）</translation>
    </message>
    <message>
        <source>What was found</source>
        <translation>見つかったもの</translation>
    </message>
    <message>
        <source>The mouse in a slice</source>
        <translation>スライスでのマウスの働き</translation>
    </message>
    <message>
        <source>This is</source>
        <translation>組織</translation>
    </message>
    <message>
        <source>Radius of the brush</source>
        <translation>ブラシの半径</translation>
    </message>
    <message>
        <source>Radius</source>
        <translation>半径</translation>
    </message>
    <message>
        <source>Radius of the lesion</source>
        <translation>病変の半径</translation>
    </message>
    <message>
        <source> mm</source>
        <translation> mm</translation>
    </message>
    <message>
        <source>Decided by hand</source>
        <translation>手動の決定</translation>
    </message>
    <message>
        <source>What you said; the last one wins</source>
        <translation>指定した内容。後のものが優先されます</translation>
    </message>
    <message>
        <source>Take back</source>
        <translation>取り消す</translation>
    </message>
    <message>
        <source>Take the chosen decision back</source>
        <translation>選んだ決定を取り消します</translation>
    </message>
    <message>
        <source>Other side</source>
        <translation>反対側</translation>
    </message>
    <message>
        <source>Keep what lies on the other side of the chosen plane</source>
        <translation>選んだ平面の反対側を残します</translation>
    </message>
    <message>
        <source>Thresholds found by the program</source>
        <translation>自動のしきい値に戻す</translation>
    </message>
    <message>
        <source>Forget the thresholds that were dragged</source>
        <translation>手動のしきい値を破棄します</translation>
    </message>
    <message>
        <source>Damp noise and streaks</source>
        <translation>ノイズと金属アーチファクトを抑える</translation>
    </message>
    <message>
        <source>Edges are kept</source>
        <translation>境目は保たれます</translation>
    </message>
    <message>
        <source>Look for caries</source>
        <translation>う蝕を探す</translation>
    </message>
    <message>
        <source>Dark places in enamel and dentine</source>
        <translation>エナメル質と象牙質の暗い場所</translation>
    </message>
    <message>
        <source>Colour the tissues in the slices</source>
        <translation>スライスの組織に色を付ける</translation>
    </message>
    <message>
        <source>Off: their outlines only</source>
        <translation>オフ：輪郭だけを表示します</translation>
    </message>
    <message>
        <source>Which tooth is it?</source>
        <translation>どの歯ですか</translation>
    </message>
    <message>
        <source>The scan is not read yet</source>
        <translation>スキャンはまだ読み込まれていません</translation>
    </message>
    <message>
        <source>No tooth was found yet</source>
        <translation>まだ歯が見つかっていません</translation>
    </message>
    <message>
        <source>Nothing yet</source>
        <translation>まだありません</translation>
    </message>
    <message>
        <source>mm³</source>
        <translation>mm³</translation>
    </message>
    <message>
        <source>Together</source>
        <translation>合計</translation>
    </message>
    <message>
        <source>Tissues</source>
        <translation>組織</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ToothChart</name>
    <message>
        <source>Tooth chart</source>
        <translation>歯列図</translation>
    </message>
    <message>
        <source>%1 (FDI %2, Universal %3)</source>
        <translation>%1（FDI %2、ユニバーサル %3）</translation>
    </message>
    <message>
        <source>There is no such tooth to open.</source>
        <translation>この歯は用意されていません。</translation>
    </message>
    <message>
        <source>Right</source>
        <translation>右</translation>
    </message>
    <message>
        <source>Left</source>
        <translation>左</translation>
    </message>
    <message>
        <source>Upper</source>
        <translation>上顎</translation>
    </message>
    <message>
        <source>Lower</source>
        <translation>下顎</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ViewBar</name>
    <message>
        <source>Lips and cheeks</source>
        <translation>口唇と頬</translation>
    </message>
    <message>
        <source>Those of the case; else they are held aside</source>
        <translation>症例の口唇と頬を表示します。オフのときは排除されています</translation>
    </message>
    <message>
        <source>This case has none</source>
        <translation>この症例にはありません</translation>
    </message>
    <message>
        <source>Views and look</source>
        <translation>視点と表示</translation>
    </message>
    <message>
        <source>Look from</source>
        <translation>見る方向</translation>
    </message>
    <message>
        <source>Whole tooth</source>
        <translation>歯全体</translation>
    </message>
    <message>
        <source>Show the whole tooth (Home)</source>
        <translation>歯全体を表示します（Home）</translation>
    </message>
    <message>
        <source>What to see</source>
        <translation>表示するもの</translation>
    </message>
    <message>
        <source>Colours</source>
        <translation>配色</translation>
    </message>
    <message>
        <source>Colours of the tissues</source>
        <translation>組織の配色</translation>
    </message>
    <message>
        <source>As in the mouth</source>
        <translation>口腔内の色</translation>
    </message>
    <message>
        <source>As in a textbook</source>
        <translation>教科書の色</translation>
    </message>
    <message>
        <source>For any colour vision</source>
        <translation>色覚に配慮した色</translation>
    </message>
    <message>
        <source>Tooth</source>
        <translation>歯</translation>
    </message>
    <message>
        <source>The tooth now, before, or both</source>
        <translation>現在の歯、切削前の歯、または両方を表示します</translation>
    </message>
    <message>
        <source>As it is now</source>
        <translation>現在</translation>
    </message>
    <message>
        <source>Before cutting</source>
        <translation>切削前</translation>
    </message>
    <message>
        <source>Removed part as glass</source>
        <translation>削った部分を半透明で</translation>
    </message>
    <message>
        <source>Quality</source>
        <translation>画質</translation>
    </message>
    <message>
        <source>Finer pictures need a faster computer</source>
        <translation>画質を上げるほど速いコンピューターが必要です</translation>
    </message>
    <message>
        <source>Fast</source>
        <translation>速さ優先</translation>
    </message>
    <message>
        <source>Fine</source>
        <translation>高画質</translation>
    </message>
    <message>
        <source>Rich (needs a graphics card)</source>
        <translation>最高画質（要グラフィックスカード）</translation>
    </message>
    <message>
        <source>In depth</source>
        <translation>立体視</translation>
    </message>
    <message>
        <source>Pictures for two eyes</source>
        <translation>左右の目のための画像を表示します</translation>
    </message>
    <message>
        <source>Off</source>
        <translation>なし</translation>
    </message>
    <message>
        <source>Side by side</source>
        <translation>左右に並べる</translation>
    </message>
    <message>
        <source>Red and cyan glasses</source>
        <translation>赤シアンめがね</translation>
    </message>
    <message>
        <source>Removed depth</source>
        <translation>切削深さ</translation>
    </message>
    <message>
        <source>Colour by how much was cut away</source>
        <translation>削った深さを色で示します</translation>
    </message>
    <message>
        <source>Scale bar</source>
        <translation>スケール</translation>
    </message>
    <message>
        <source>Wet tooth</source>
        <translation>濡れた歯</translation>
    </message>
    <message>
        <source>Shine of wet enamel</source>
        <translation>濡れたエナメル質のつやを表示します</translation>
    </message>
    <message>
        <source>Colours of the scan</source>
        <translation>スキャンの色</translation>
    </message>
    <message>
        <source>As an intraoral scanner saw the uncut surface; with colours as in the mouth</source>
        <translation>削っていない表面を口腔内スキャナーが撮影した色で表示します（「口腔内の色」のとき）</translation>
    </message>
    <message>
        <source>No surface of this case was scanned in colour</source>
        <translation>このケースには色付きでスキャンされた表面がありません</translation>
    </message>
    <message>
        <source>Water spray</source>
        <translation>注水</translation>
    </message>
    <message>
        <source>Water from the handpiece</source>
        <translation>ハンドピースからの注水を表示します</translation>
    </message>
    <message>
        <source>Debris</source>
        <translation>切削片</translation>
    </message>
    <message>
        <source>What flies off while cutting</source>
        <translation>切削中に飛ぶ切削片を表示します</translation>
    </message>
    <message>
        <source>Shadows</source>
        <translation>影</translation>
    </message>
    <message>
        <source>Shade in fissures and cavities</source>
        <translation>裂溝や窩洞の影を表示します</translation>
    </message>
    <message>
        <source>Handpiece</source>
        <translation>ハンドピース</translation>
    </message>
    <message>
        <source>The handpiece that holds the bur</source>
        <translation>バーを保持するハンドピースを表示します</translation>
    </message>
    <message>
        <source>Contact arrow</source>
        <translation>接触点</translation>
    </message>
    <message>
        <source>Where the bur touches</source>
        <translation>バーが触れている場所を示します</translation>
    </message>
    <message>
        <source>Force arrow</source>
        <translation>力の矢印</translation>
    </message>
    <message>
        <source>The force on the hand</source>
        <translation>手に伝わる力を示します</translation>
    </message>
    <message>
        <source>Tissues shown</source>
        <translation>表示する組織</translation>
    </message>
    <message>
        <source>Show or hide: %1</source>
        <translation>表示・非表示：%1</translation>
    </message>
    <message>
        <source>Locked by this exercise.</source>
        <translation>この課題では変更できません。</translation>
    </message>
    <message>
        <source>Mesial</source>
        <translation>近心</translation>
    </message>
    <message>
        <source>Distal</source>
        <translation>遠心</translation>
    </message>
    <message>
        <source>A scale in millimetres in the picture</source>
        <translation>画像の中のミリメートル目盛り</translation>
    </message>
    <message>
        <source>Occlusal</source>
        <translation>咬合面</translation>
    </message>
    <message>
        <source>Occlusal view (1)</source>
        <translation>咬合面観（1）</translation>
    </message>
    <message>
        <source>Buccal</source>
        <translation>頬側</translation>
    </message>
    <message>
        <source>Buccal view (2)</source>
        <translation>頬側面観（2）</translation>
    </message>
    <message>
        <source>Lingual</source>
        <translation>舌側</translation>
    </message>
    <message>
        <source>Lingual view (3)</source>
        <translation>舌側面観（3）</translation>
    </message>
    <message>
        <source>Mesial view (4)</source>
        <translation>近心面観（4）</translation>
    </message>
    <message>
        <source>Distal view (5)</source>
        <translation>遠心面観（5）</translation>
    </message>
    <message>
        <source>Oblique</source>
        <translation>斜め</translation>
    </message>
    <message>
        <source>Oblique view, occlusal and buccal (6)</source>
        <translation>斜め（咬合面・頬側）から見ます（6）</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ViewWidget</name>
    <message>
        <source>%1: cut   ·   %2: turn the view   ·   %3: all keys</source>
        <translation>%1：切削   ·   %2：視点を回す   ·   %3：キーの一覧</translation>
    </message>
    <message>
        <source>No tooth under the pointer</source>
        <translation>ポインターの下に歯がありません</translation>
    </message>
    <message>
        <source>At the depth stop</source>
        <translation>深さ制限に達しています</translation>
    </message>
    <message>
        <source>No deeper here: the bur would come out of the tooth</source>
        <translation>ここではこれ以上深くできません：バーが歯を突き抜けます</translation>
    </message>
    <message>
        <source>The bur is on its way</source>
        <translation>バーを移動しています</translation>
    </message>
    <message>
        <source>The bur is stalled: press less</source>
        <translation>バーが止まっています：押す力を弱めてください</translation>
    </message>
    <message>
        <source>The bur does not cut here: press more, or take another bur</source>
        <translation>ここは切削できません：もっと強く押すか、別のバーを使ってください</translation>
    </message>
    <message>
        <source>Drag, turn the wheel or use the arrow keys to move the section</source>
        <translation>ドラッグ、ホイール、矢印キーで断面を動かします</translation>
    </message>
    <message>
        <source>Drag the mirror; the wheel moves it nearer or farther</source>
        <translation>ミラーはドラッグで動かし、ホイールで近づけたり遠ざけたりします</translation>
    </message>
    <message>
        <source>The picture cannot be drawn: %1</source>
        <translation>画面を描画できません：%1</translation>
    </message>
    <message>
        <source>No tooth is open</source>
        <translation>歯が開かれていません</translation>
    </message>
    <message>
        <source>Picture of the tooth</source>
        <translation>歯の画面</translation>
    </message>
    <message>
        <source>Mouse and keys move the bur; F1 shows them.</source>
        <translation>マウスとキーでバーを動かします。F1 で一覧を表示します。</translation>
    </message>
    <message>
        <source>Second point: click, or arrows and %1</source>
        <translation>2 点目：クリック、または矢印と %1</translation>
    </message>
    <message>
        <source>First point: click, or arrows and %1</source>
        <translation>1 点目：クリック、または矢印と %1</translation>
    </message>
    <message>
        <source>Point at the cavity&apos;s floor; a click or %1 keeps the reading</source>
        <translation>窩底を指してください。クリックまたは %1 で値を残します</translation>
    </message>
    <message>
        <source>Point at the cavity&apos;s floor; a click or %1 keeps the remaining dentine thickness</source>
        <translation>窩底を指してください。クリックまたは %1 で残存象牙質の厚さを残します</translation>
    </message>
    <message>
        <source>Drag a landmark over the tooth, or move the one chosen with the arrow keys</source>
        <translation>指標点を歯の上でドラッグするか、選んだものを矢印キーで動かします</translation>
    </message>
    <message>
        <source>So quickly it cuts next to nothing: go slower, or press more</source>
        <translation>速すぎてほとんど削れません。ゆっくり動かすか、強く押してください</translation>
    </message>
    <message>
        <source>As deep as one pass goes: let go and press again to go deeper</source>
        <translation>1回の深さに達しました。さらに深く削るには、放してもう一度押してください</translation>
    </message>
    <message>
        <source>Off what this stroke began on: let go, and press here to work here</source>
        <translation>この切削を始めた場所から外れています。ここを削るには、放してから押してください</translation>
    </message>
    <message>
        <source>The handpiece cannot get there: turn the view, tilt it or take another bur</source>
        <translation>ハンドピースが届きません。視点を回すか、傾けるか、別のバーを使ってください</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::VolumeBars</name>
    <message>
        <source>mm³</source>
        <translation>mm³</translation>
    </message>
    <message>
        <source>Removed of each tissue</source>
        <translation>組織ごとの切削量</translation>
    </message>
    <message>
        <source>Removed</source>
        <translation>切削量</translation>
    </message>
    <message>
        <source>Nothing yet</source>
        <translation>まだありません</translation>
    </message>
    <message>
        <source>%1: %2 cut away since the tooth was whole</source>
        <translation>%1：切削を始めてから %2 削りました</translation>
    </message>
    <message>
        <source>What was cut away since the tooth was whole</source>
        <translation>切削を始めてから削った量です</translation>
    </message>
    <message>
        <source>Total</source>
        <translation>合計</translation>
    </message>
    <message>
        <source>This exercise hides the volumes.</source>
        <translation>この課題では切削量を表示しません。</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::WelcomeStrip</name>
    <message>
        <source>First steps</source>
        <translation>はじめに</translation>
    </message>
    <message>
        <source>Show no hints</source>
        <translation>ヒントを表示しない</translation>
    </message>
    <message>
        <source>Move the mouse over the tooth. Hold the left button to cut.</source>
        <translation>マウスを歯の上に動かし、左ボタンを押し続けると削れます。</translation>
    </message>
    <message>
        <source>Move the handpiece to the tooth. Hold its upper button to cut.</source>
        <translation>ハンドピースを歯に近づけ、上のボタンを押し続けると削れます。</translation>
    </message>
    <message>
        <source>Hold the left button and drag to cut.</source>
        <translation>左ボタンを押したまま動かすと削れます。</translation>
    </message>
    <message>
        <source>Hold the upper button to cut.</source>
        <translation>上のボタンを押し続けると削れます。</translation>
    </message>
    <message>
        <source>Hold the right mouse button and drag to look from another side.</source>
        <translation>右ボタンを押したまま動かすと、別の側から見られます。</translation>
    </message>
    <message>
        <source>Turn the mouse wheel to come nearer.</source>
        <translation>マウスのホイールを回すと近づけます。</translation>
    </message>
    <message>
        <source>Something went wrong? Ctrl+Z takes the last stroke back.</source>
        <translation>失敗したときは、Ctrl+Z で直前のストロークを元に戻せます。</translation>
    </message>
    <message>
        <source>%1 of %2</source>
        <translation>%1 / %2</translation>
    </message>
</context>
<context>
    <name>Landmarks</name>
    <message>
        <source>Cusp tip</source>
        <translation>咬頭頂</translation>
    </message>
    <message>
        <source>Pit</source>
        <translation>小窩</translation>
    </message>
    <message>
        <source>Contact</source>
        <translation>接触点</translation>
    </message>
    <message>
        <source>Pulp horn</source>
        <translation>髄角</translation>
    </message>
    <message>
        <source>Orifice</source>
        <translation>根管口</translation>
    </message>
    <message>
        <source>Furcation</source>
        <translation>根分岐部</translation>
    </message>
    <message>
        <source>Apex</source>
        <translation>根尖</translation>
    </message>
    <message>
        <source>Fissure</source>
        <translation>裂溝</translation>
    </message>
    <message>
        <source>Marginal ridge</source>
        <translation>辺縁隆線</translation>
    </message>
    <message>
        <source>Ridge</source>
        <translation>隆線</translation>
    </message>
    <message>
        <source>Height of contour</source>
        <translation>最大豊隆部</translation>
    </message>
    <message>
        <source>Cemento-enamel junction</source>
        <translation>セメント・エナメル境</translation>
    </message>
    <message>
        <source>Long axis</source>
        <translation>歯軸</translation>
    </message>
    <message>
        <source>Path of insertion</source>
        <translation>着脱方向</translation>
    </message>
    <message>
        <source>generated</source>
        <translation>生成</translation>
    </message>
    <message>
        <source>found</source>
        <translation>検出</translation>
    </message>
    <message>
        <source>set by hand</source>
        <translation>手動で設定</translation>
    </message>
    <message>
        <source>mesiobuccal</source>
        <translation>近心頬側</translation>
    </message>
    <message>
        <source>distobuccal</source>
        <translation>遠心頬側</translation>
    </message>
    <message>
        <source>mesiolingual</source>
        <translation>近心舌側</translation>
    </message>
    <message>
        <source>distolingual</source>
        <translation>遠心舌側</translation>
    </message>
    <message>
        <source>mesiopalatal</source>
        <translation>近心口蓋側</translation>
    </message>
    <message>
        <source>distopalatal</source>
        <translation>遠心口蓋側</translation>
    </message>
    <message>
        <source>mesial</source>
        <translation>近心</translation>
    </message>
    <message>
        <source>distal</source>
        <translation>遠心</translation>
    </message>
    <message>
        <source>buccal</source>
        <translation>頬側</translation>
    </message>
    <message>
        <source>lingual</source>
        <translation>舌側</translation>
    </message>
    <message>
        <source>palatal</source>
        <translation>口蓋側</translation>
    </message>
    <message>
        <source>labial</source>
        <translation>唇側</translation>
    </message>
    <message>
        <source>central</source>
        <translation>中心</translation>
    </message>
    <message>
        <source>second</source>
        <translation>第二</translation>
    </message>
    <message>
        <source>triangular</source>
        <translation>三角</translation>
    </message>
    <message>
        <source>transverse</source>
        <translation>横走</translation>
    </message>
    <message>
        <source>oblique</source>
        <translation>斜走</translation>
    </message>
    <message>
        <source>marginal</source>
        <translation>辺縁</translation>
    </message>
    <message>
        <source>incisal</source>
        <translation>切縁</translation>
    </message>
    <message>
        <source>edge</source>
        <translation>縁</translation>
    </message>
    <message>
        <source>cusp</source>
        <translation>咬頭</translation>
    </message>
    <message>
        <source>ridge</source>
        <translation>隆線</translation>
    </message>
    <message>
        <source>%1, %2</source>
        <translation>%1、%2</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ChartDialog</name>
    <message>
        <source>Mouth</source>
        <translation>口腔</translation>
    </message>
    <message>
        <source>A patient that the program makes, or a case from the folders of your cases</source>
        <translation>プログラムが作る患者、または症例フォルダーにある症例</translation>
    </message>
    <message>
        <source>Notation</source>
        <translation>歯式</translation>
    </message>
    <message>
        <source>How teeth are numbered</source>
        <translation>歯の番号の付け方を選びます</translation>
    </message>
    <message>
        <source>Patient&apos;s number</source>
        <translation>患者の番号</translation>
    </message>
    <message>
        <source>Another number is another patient; 0 is the average of all</source>
        <translation>番号を変えると別の患者になります。0 は全体の平均です</translation>
    </message>
    <message>
        <source>Patient&apos;s age</source>
        <translation>患者の年齢</translation>
    </message>
    <message>
        <source>With age the pulp shrinks and cusps wear</source>
        <translation>年齢とともに歯髄は狭くなり、咬頭は咬耗します</translation>
    </message>
    <message>
        <source>In the whole mouth</source>
        <translation>口腔全体で</translation>
    </message>
    <message>
        <source>With the other teeth, gingiva and bone; otherwise the tooth stands alone</source>
        <translation>ほかの歯、歯肉、骨と一緒に。外すと歯だけになります</translation>
    </message>
    <message>
        <source>Choose a tooth</source>
        <translation>歯を選ぶ</translation>
    </message>
    <message>
        <source>A patient of the program</source>
        <translation>プログラムの患者</translation>
    </message>
    <message>
        <source>FDI (ISO 3950)</source>
        <translation>FDI (ISO 3950)</translation>
    </message>
    <message>
        <source>Universal</source>
        <translation>ユニバーサル</translation>
    </message>
    <message>
        <source>Palmer</source>
        <translation>パーマー（ジグモンディ）</translation>
    </message>
    <message>
        <source> years</source>
        <translation> 歳</translation>
    </message>
    <message>
        <source>Patient</source>
        <translation>患者</translation>
    </message>
    <message>
        <source>Age</source>
        <translation>年齢</translation>
    </message>
    <message>
        <source>Reading cases</source>
        <translation>症例を読み込み中</translation>
    </message>
    <message>
        <source>%1 (%2)</source>
        <translation>%1（%2）</translation>
    </message>
    <message>
        <source>The teeth of this case, as they are. Any of them can be the one worked on.</source>
        <translation>この症例の歯をそのままの形で示します。どの歯でも処置できます。</translation>
    </message>
    <message>
        <source>Case: %1</source>
        <translation>症例：%1</translation>
    </message>
    <message>
        <source>The first tooth of a new patient takes a while: the whole mouth is made.</source>
        <translation>新しい患者の最初の歯には時間がかかります。口腔全体を作るためです。</translation>
    </message>
    <message>
        <source>Of teeth with a dot there are cases as well.</source>
        <translation>点の付いた歯には症例もあります。</translation>
    </message>
    <message>
        <source>This patient&apos;s tooth</source>
        <translation>この患者の歯</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::LandmarksFeature</name>
    <message>
        <source>Save the landmarks?</source>
        <translation>指標点を保存しますか？</translation>
    </message>
    <message>
        <source>Landmarks were changed, and no case holds that yet.</source>
        <translation>指標点が変更されましたが、まだどの症例にも保存されていません。</translation>
    </message>
    <message>
        <source>Landmarks</source>
        <translation>解剖学的指標点</translation>
    </message>
    <message>
        <source>In an exercise landmarks are read only.</source>
        <translation>課題では指標点は見るだけです。</translation>
    </message>
    <message>
        <source>What is only watched is read only.</source>
        <translation>再生や閲覧中は見るだけです。</translation>
    </message>
    <message>
        <source>Looking for landmarks...</source>
        <translation>指標点を検出しています...</translation>
    </message>
    <message>
        <source>Click the tooth where it is to be. Undo takes the last click back.</source>
        <translation>歯の上の置きたい位置をクリックしてください。「元に戻す」で最後のクリックを取り消します。</translation>
    </message>
    <message>
        <source>Changed, and not saved yet.</source>
        <translation>変更しましたが、まだ保存していません。</translation>
    </message>
    <message>
        <source>Finding landmarks</source>
        <translation>指標点の検出</translation>
    </message>
    <message>
        <source>Found by shape: %1.</source>
        <translation>形態から検出: %1。</translation>
    </message>
    <message>
        <source>Not found: %1.</source>
        <translation>検出できなかったもの: %1。</translation>
    </message>
    <message>
        <source>This tooth has no number of a permanent tooth: only what goes around it.</source>
        <translation>永久歯の歯番がないため、歯を一周するものだけを検出しました。</translation>
    </message>
    <message>
        <source>Save as a case with these landmarks</source>
        <translation>この指標点を持つ症例として保存</translation>
    </message>
    <message>
        <source>Case (*.handpiece)</source>
        <translation>症例 (*.handpiece)</translation>
    </message>
    <message>
        <source>Saving the landmarks</source>
        <translation>指標点を保存中</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::LandmarksPanel</name>
    <message>
        <source>Landmarks</source>
        <translation>解剖学的指標点</translation>
    </message>
    <message>
        <source>What is ticked is shown over the tooth; the one chosen is moved by the arrow keys</source>
        <translation>チェックしたものを歯の上に示します。選んだものは矢印キーで動かせます</translation>
    </message>
    <message>
        <source>Undo</source>
        <translation>元に戻す</translation>
    </message>
    <message>
        <source>Take the last change back</source>
        <translation>最後の変更を取り消します</translation>
    </message>
    <message>
        <source>Find</source>
        <translation>検出</translation>
    </message>
    <message>
        <source>Find landmarks</source>
        <translation>指標点を検出</translation>
    </message>
    <message>
        <source>Look for landmarks by the tooth&apos;s shape; what was set by hand stays</source>
        <translation>歯の形態から指標点を探します。手で設定したものは残ります</translation>
    </message>
    <message>
        <source>Finding landmarks</source>
        <translation>指標点の検出</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>キャンセル</translation>
    </message>
    <message>
        <source>Kind of the landmark to set</source>
        <translation>設定する指標点の種類</translation>
    </message>
    <message>
        <source>Name of the landmark to set</source>
        <translation>設定する指標点の名前</translation>
    </message>
    <message>
        <source>One that this tooth lacks, or another name</source>
        <translation>この歯にまだないもの、または別の名前</translation>
    </message>
    <message>
        <source>Set</source>
        <translation>設定</translation>
    </message>
    <message>
        <source>Done</source>
        <translation>完了</translation>
    </message>
    <message>
        <source>Set by hand</source>
        <translation>手で設定</translation>
    </message>
    <message>
        <source>Click the tooth where it is to be: a line or ring point by point, then press again</source>
        <translation>歯の上の位置をクリックします。線や輪は一点ずつクリックし、最後にもう一度押します</translation>
    </message>
    <message>
        <source>Delete</source>
        <translation>削除</translation>
    </message>
    <message>
        <source>Remove the one chosen</source>
        <translation>選んだものを削除します</translation>
    </message>
    <message>
        <source>Put back</source>
        <translation>元の位置へ</translation>
    </message>
    <message>
        <source>The one chosen, or all when none is, back to where the case had it</source>
        <translation>選んだもの、選んでいなければすべてを、症例にあった位置へ戻します</translation>
    </message>
    <message>
        <source>Save...</source>
        <translation>保存...</translation>
    </message>
    <message>
        <source>Save the landmarks</source>
        <translation>指標点を保存</translation>
    </message>
    <message>
        <source>Keep the landmarks in the case; a tooth of the program becomes a case of your own</source>
        <translation>指標点を症例に保存します。プログラムの歯は自分の症例になります</translation>
    </message>
    <message>
        <source>Landmark</source>
        <translation>指標点</translation>
    </message>
    <message>
        <source>Source</source>
        <translation>由来</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::AgreementPage</name>
    <message>
        <source>Agreement</source>
        <translation>一致度</translation>
    </message>
    <message>
        <source>Weighted kappa (linear), ICC(2,1), Krippendorff&apos;s alpha, bias and limits of agreement, with 95 % intervals</source>
        <translation>重み付きカッパ（線形）、級内相関係数 (2,1)、クリッペンドルフのアルファ、偏りと一致の限界（95 % 区間付き）</translation>
    </message>
    <message>
        <source>Of</source>
        <translation>対象</translation>
    </message>
    <message>
        <source>Works</source>
        <translation>作品数</translation>
    </message>
    <message>
        <source>Coefficient</source>
        <translation>係数</translation>
    </message>
    <message>
        <source>Value (95 %)</source>
        <translation>値（95 %）</translation>
    </message>
    <message>
        <source>Picture</source>
        <translation>図</translation>
    </message>
    <message>
        <source>Plot of the agreement</source>
        <translation>一致度の図</translation>
    </message>
    <message>
        <source>undefined: %1</source>
        <translation>定義されません：%1</translation>
    </message>
    <message>
        <source>%1 (%2 to %3)</source>
        <translation>%1（%2 ～ %3）</translation>
    </message>
    <message>
        <source>%1 and %2</source>
        <translation>%1 と %2</translation>
    </message>
    <message>
        <source>weighted kappa</source>
        <translation>重み付きカッパ</translation>
    </message>
    <message>
        <source>bias, limits of agreement</source>
        <translation>偏り、一致の限界</translation>
    </message>
    <message>
        <source>all raters</source>
        <translation>全評価者</translation>
    </message>
    <message>
        <source>Krippendorff&apos;s alpha</source>
        <translation>クリッペンドルフのアルファ</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::DeskDialog</name>
    <message>
        <source>Marking desk</source>
        <translation>採点机</translation>
    </message>
    <message>
        <source>Pages of the marking desk</source>
        <translation>採点机のページ</translation>
    </message>
    <message>
        <source>What is marked</source>
        <translation>採点の対象</translation>
    </message>
    <message>
        <source>Works</source>
        <translation>作品</translation>
    </message>
    <message>
        <source>Agreement</source>
        <translation>一致度</translation>
    </message>
    <message>
        <source>How far it is</source>
        <translation>進み具合</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>中止</translation>
    </message>
    <message>
        <source>Stop; what has been scored so far stays</source>
        <translation>止めます。ここまでの得点は残ります</translation>
    </message>
    <message>
        <source>Folder of the returned work</source>
        <translation>提出物のフォルダー</translation>
    </message>
    <message>
        <source>Sessions, attempts, hand-ins; a folder can be dropped here</source>
        <translation>記録、試行、提出ファイル。フォルダーをここへドロップできます</translation>
    </message>
    <message>
        <source>Choose...</source>
        <translation>選択...</translation>
    </message>
    <message>
        <source>Choose the folder</source>
        <translation>フォルダーを選ぶ</translation>
    </message>
    <message>
        <source>Returned work</source>
        <translation>提出物</translation>
    </message>
    <message>
        <source>Exercise</source>
        <translation>課題</translation>
    </message>
    <message>
        <source>The exercise that was worked on: its folder, or its .handpiece file</source>
        <translation>行われた課題：そのフォルダー、または一つにまとめたファイル</translation>
    </message>
    <message>
        <source>Choose the exercise</source>
        <translation>課題を選ぶ</translation>
    </message>
    <message>
        <source>Rubric</source>
        <translation>ルーブリック</translation>
    </message>
    <message>
        <source>How the machine scores, and what is marked</source>
        <translation>機械の採点の仕方と、評価する項目</translation>
    </message>
    <message>
        <source>The exercise&apos;s own</source>
        <translation>課題自身のもの</translation>
    </message>
    <message>
        <source>File...</source>
        <translation>ファイル...</translation>
    </message>
    <message>
        <source>A rubric of your own</source>
        <translation>自分のルーブリック</translation>
    </message>
    <message>
        <source>Marker</source>
        <translation>採点者</translation>
    </message>
    <message>
        <source>Your name or code: each marker has a desk of their own in the folder</source>
        <translation>名前またはコード。採点者ごとに、フォルダー内に自分の机があります</translation>
    </message>
    <message>
        <source>Mark blind</source>
        <translation>ブラインド採点</translation>
    </message>
    <message>
        <source>Works come under codes in random order, a tenth of them twice; the machine&apos;s score is hidden until your own mark is in</source>
        <translation>作品はコードで無作為の順に現れ、十分の一は二度現れます。自分の評価を出すまで機械の得点は隠されます</translation>
    </message>
    <message>
        <source>Cut recordings again to prove them</source>
        <translation>記録を切削し直して証明する</translation>
    </message>
    <message>
        <source>Slower; without it every recording is unproven</source>
        <translation>時間がかかります。しなければ記録はすべて未証明です</translation>
    </message>
    <message>
        <source>Begin, or go on</source>
        <translation>始める・続ける</translation>
    </message>
    <message>
        <source>What this marker did in this folder before is taken up again</source>
        <translation>この採点者がこのフォルダーで前にしたことを引き継ぎます</translation>
    </message>
    <message>
        <source>Double click or Enter opens a work</source>
        <translation>ダブルクリックか Enter で作品を開きます</translation>
    </message>
    <message>
        <source>Critical errors</source>
        <translation>重大な誤り</translation>
    </message>
    <message>
        <source>Only works with a critical error</source>
        <translation>重大な誤りのある作品だけ</translation>
    </message>
    <message>
        <source>Borderline</source>
        <translation>境界</translation>
    </message>
    <message>
        <source>Only works where something lies within uncertainty</source>
        <translation>不確かさの範囲に入るものがある作品だけ</translation>
    </message>
    <message>
        <source>Unproven</source>
        <translation>未証明</translation>
    </message>
    <message>
        <source>Only works that were not cut again to the same tooth</source>
        <translation>切削し直して同じ歯になっていない作品だけ</translation>
    </message>
    <message>
        <source>Not scored</source>
        <translation>採点不能</translation>
    </message>
    <message>
        <source>Only works that could not be scored</source>
        <translation>採点できなかった作品だけ</translation>
    </message>
    <message>
        <source>How many works</source>
        <translation>作品の数</translation>
    </message>
    <message>
        <source>Open</source>
        <translation>開く</translation>
    </message>
    <message>
        <source>Open the work in the picture</source>
        <translation>作品を画面に開く</translation>
    </message>
    <message>
        <source>Score again</source>
        <translation>再採点</translation>
    </message>
    <message>
        <source>Look for work that has come since, and score what has no score</source>
        <translation>後から届いた作品を探し、得点のないものを採点します</translation>
    </message>
    <message>
        <source>Export</source>
        <translation>書き出し</translation>
    </message>
    <message>
        <source>Write tables for others</source>
        <translation>ほかの人のための表を書き出します</translation>
    </message>
    <message>
        <source>Results, codes only (CSV)...</source>
        <translation>結果、コードのみ（CSV）...</translation>
    </message>
    <message>
        <source>Results with file names (CSV)...</source>
        <translation>結果、ファイル名付き（CSV）...</translation>
    </message>
    <message>
        <source>Blind marks, for agreement (CSV)...</source>
        <translation>ブラインド評価、一致度用（CSV）...</translation>
    </message>
    <message>
        <source>Agreement with pictures (folder)...</source>
        <translation>一致度と図（フォルダー）...</translation>
    </message>
    <message>
        <source>Works: %1 of %2</source>
        <translation>作品：%1 / %2</translation>
    </message>
    <message>
        <source>Marks for each student (folder)...</source>
        <translation>受講者ごとの評価（フォルダー）...</translation>
    </message>
    <message>
        <source>Page of the class, with file names...</source>
        <translation>クラスのページ（ファイル名付き）...</translation>
    </message>
    <message>
        <source>Marks in: %1 of %2</source>
        <translation>評価済み：%1 / %2</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::MarkingFeature</name>
    <message>
        <source>Marking</source>
        <translation>採点</translation>
    </message>
    <message>
        <source>Folder of the returned work</source>
        <translation>提出物のフォルダー</translation>
    </message>
    <message>
        <source>Exercise</source>
        <translation>課題</translation>
    </message>
    <message>
        <source>Exercises (*.handpiece exercise.toml);;All files (*)</source>
        <translation>課題 (*.handpiece exercise.toml);;すべてのファイル (*)</translation>
    </message>
    <message>
        <source>Rubric</source>
        <translation>ルーブリック</translation>
    </message>
    <message>
        <source>Rubrics (*.toml);;All files (*)</source>
        <translation>ルーブリック (*.toml);;すべてのファイル (*)</translation>
    </message>
    <message>
        <source>Cancelled. What has been scored stays; &quot;Score again&quot; goes on.</source>
        <translation>中止しました。ここまでの得点は残ります。「再採点」で続けられます。</translation>
    </message>
    <message>
        <source>Looking for work</source>
        <translation>作品を探しています</translation>
    </message>
    <message>
        <source>There is no returned work in this folder.</source>
        <translation>このフォルダーに提出物はありません。</translation>
    </message>
    <message>
        <source>Scoring</source>
        <translation>採点中</translation>
    </message>
    <message>
        <source>Opening %1</source>
        <translation>%1 を開いています</translation>
    </message>
    <message>
        <source>%1 of %2</source>
        <translation>%1 / %2</translation>
    </message>
    <message>
        <source>There is no tooth in the middle of the picture: the comment has no place.</source>
        <translation>画面の中央に歯がないため、コメントに位置が付きません。</translation>
    </message>
    <message>
        <source>Computing...</source>
        <translation>計算中...</translation>
    </message>
    <message>
        <source>Agreement</source>
        <translation>一致度</translation>
    </message>
    <message>
        <source>There is nothing to compare yet: marks count once they are in.</source>
        <translation>まだ比べるものがありません。評価は出されてから数えられます。</translation>
    </message>
    <message>
        <source>Marks that were given blind alone; works whose machine&apos;s score is hidden are left out.</source>
        <translation>ブラインドで出された評価だけです。機械の得点が隠れている作品は除かれます。</translation>
    </message>
    <message>
        <source>Folder for the agreement</source>
        <translation>一致度のフォルダー</translation>
    </message>
    <message>
        <source>Write the table</source>
        <translation>表を書き出す</translation>
    </message>
    <message>
        <source>Table (*.csv)</source>
        <translation>表 (*.csv)</translation>
    </message>
    <message>
        <source>Return to student</source>
        <translation>受講者へ返却</translation>
    </message>
    <message>
        <source>Marks (*.json)</source>
        <translation>評価 (*.json)</translation>
    </message>
    <message>
        <source>Folder for the marks</source>
        <translation>評価を書くフォルダー</translation>
    </message>
    <message>
        <source>Write the page</source>
        <translation>ページを書き出す</translation>
    </message>
    <message>
        <source>Page (*.html)</source>
        <translation>ページ (*.html)</translation>
    </message>
    <message>
        <source>%1 cannot be opened; why is told once your marks are in.</source>
        <translation>%1 を開けません。理由は評価の確定後に示します。</translation>
    </message>
    <message>
        <source>It may go in without marks.</source>
        <translation>評価なしで確定できます。</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::SheetPanel</name>
    <message>
        <source>Work that is marked</source>
        <translation>採点中の作品</translation>
    </message>
    <message>
        <source>Code of the work</source>
        <translation>作品のコード</translation>
    </message>
    <message>
        <source>Previous work</source>
        <translation>前の作品</translation>
    </message>
    <message>
        <source>Next work</source>
        <translation>次の作品</translation>
    </message>
    <message>
        <source>Back to the table</source>
        <translation>表に戻る</translation>
    </message>
    <message>
        <source>Criteria</source>
        <translation>評価項目</translation>
    </message>
    <message>
        <source>Choose one to judge it; a place below it turns the picture there</source>
        <translation>選ぶと評価できます。下にある場所を選ぶと画面がそこへ向きます</translation>
    </message>
    <message>
        <source>Criterion</source>
        <translation>評価項目</translation>
    </message>
    <message>
        <source>Your mark</source>
        <translation>自分の評価</translation>
    </message>
    <message>
        <source>Measured</source>
        <translation>測定値</translation>
    </message>
    <message>
        <source>Band</source>
        <translation>段階</translation>
    </message>
    <message>
        <source>Points</source>
        <translation>得点</translation>
    </message>
    <message>
        <source>Criterion that is judged</source>
        <translation>評価中の項目</translation>
    </message>
    <message>
        <source>Critical error</source>
        <translation>重大な誤り</translation>
    </message>
    <message>
        <source>Cannot be told</source>
        <translation>判断できない</translation>
    </message>
    <message>
        <source>Reason</source>
        <translation>理由</translation>
    </message>
    <message>
        <source>Why you judge otherwise: it is kept</source>
        <translation>評価を変える理由。保存されます</translation>
    </message>
    <message>
        <source>Reason, needed</source>
        <translation>理由（必須）</translation>
    </message>
    <message>
        <source>Judge</source>
        <translation>評価する</translation>
    </message>
    <message>
        <source>Take back</source>
        <translation>取り消す</translation>
    </message>
    <message>
        <source>The machine&apos;s judgement stands again</source>
        <translation>機械の評価に戻します</translation>
    </message>
    <message>
        <source>My marks are in</source>
        <translation>評価を出す</translation>
    </message>
    <message>
        <source>They are fixed then, and the machine&apos;s score is shown</source>
        <translation>評価が確定し、機械の得点が表示されます</translation>
    </message>
    <message>
        <source>Who passes</source>
        <translation>合否</translation>
    </message>
    <message>
        <source>as scored</source>
        <translation>得点のとおり</translation>
    </message>
    <message>
        <source>passed</source>
        <translation>合格</translation>
    </message>
    <message>
        <source>not passed</source>
        <translation>不合格</translation>
    </message>
    <message>
        <source>Reason of the decision</source>
        <translation>判定の理由</translation>
    </message>
    <message>
        <source>Decide</source>
        <translation>判定</translation>
    </message>
    <message>
        <source>Decide who passes</source>
        <translation>合否を判定する</translation>
    </message>
    <message>
        <source>Comments</source>
        <translation>コメント</translation>
    </message>
    <message>
        <source>One that has a place turns the picture there</source>
        <translation>位置のあるものを選ぶと画面がそこへ向きます</translation>
    </message>
    <message>
        <source>New comment</source>
        <translation>新しいコメント</translation>
    </message>
    <message>
        <source>Pinned to the criterion that is chosen</source>
        <translation>選んだ評価項目に付きます</translation>
    </message>
    <message>
        <source>Comment</source>
        <translation>コメント</translation>
    </message>
    <message>
        <source>at the middle of the picture</source>
        <translation>画面の中央に</translation>
    </message>
    <message>
        <source>Pin it to the place in the middle of the picture</source>
        <translation>画面の中央の場所に付けます</translation>
    </message>
    <message>
        <source>at this moment</source>
        <translation>この時点に</translation>
    </message>
    <message>
        <source>Pin it to the moment that the replay shows</source>
        <translation>再生で見えている時点に付けます</translation>
    </message>
    <message>
        <source>Add</source>
        <translation>追加</translation>
    </message>
    <message>
        <source>Add the comment</source>
        <translation>コメントを追加</translation>
    </message>
    <message>
        <source>Delete</source>
        <translation>削除</translation>
    </message>
    <message>
        <source>Delete the comment</source>
        <translation>コメントを削除</translation>
    </message>
    <message>
        <source>%1, %2</source>
        <translation>%1、%2</translation>
    </message>
    <message>
        <source>All points together</source>
        <translation>総得点</translation>
    </message>
    <message>
        <source>cannot be told</source>
        <translation>判断できない</translation>
    </message>
    <message>
        <source>%1 of %2</source>
        <translation>%1 / %2</translation>
    </message>
    <message>
        <source>%1 ± %2 %3</source>
        <translation>%1 ± %2 %3</translation>
    </message>
    <message>
        <source>critical error</source>
        <translation>重大な誤り</translation>
    </message>
    <message>
        <source>perhaps a critical error</source>
        <translation>重大な誤りの可能性</translation>
    </message>
    <message>
        <source>borderline</source>
        <translation>境界</translation>
    </message>
    <message>
        <source>machine: %1</source>
        <translation>機械：%1</translation>
    </message>
    <message>
        <source> (machine: %1)</source>
        <translation> （機械：%1）</translation>
    </message>
    <message>
        <source>at %1 s</source>
        <translation>%1 秒</translation>
    </message>
    <message>
        <source>%1 N</source>
        <translation>%1 N</translation>
    </message>
    <message>
        <source>%1: %2</source>
        <translation>%1：%2</translation>
    </message>
    <message>
        <source>%1 (at %2 s)</source>
        <translation>%1（%2 秒）</translation>
    </message>
    <message>
        <source>Open a work on the marking desk.</source>
        <translation>採点机で作品を開いてください。</translation>
    </message>
    <message>
        <source>The machine&apos;s score is hidden until your marks are in.</source>
        <translation>機械の得点は、自分の評価を出すまで隠されています。</translation>
    </message>
    <message>
        <source>It waits for its score.</source>
        <translation>採点を待っています。</translation>
    </message>
    <message>
        <source>Why: %1.</source>
        <translation>理由：%1。</translation>
    </message>
    <message>
        <source>Proven.</source>
        <translation>証明済み。</translation>
    </message>
    <message>
        <source>Unproven: %1.</source>
        <translation>未証明：%1。</translation>
    </message>
    <message>
        <source>choose</source>
        <translation>選択</translation>
    </message>
    <message>
        <source>band as it is</source>
        <translation>段階はそのまま</translation>
    </message>
    <message>
        <source>critical: as it is</source>
        <translation>重大な誤り：そのまま</translation>
    </message>
    <message>
        <source>no critical error</source>
        <translation>重大な誤りなし</translation>
    </message>
    <message>
        <source> of %1</source>
        <translation> / %1</translation>
    </message>
    <message>
        <source>Mark</source>
        <translation>評価する</translation>
    </message>
    <message>
        <source>Override</source>
        <translation>変更する</translation>
    </message>
    <message>
        <source>How the work stands</source>
        <translation>作品の状況</translation>
    </message>
    <message>
        <source>%1 of %2 points (machine: %3): %4.</source>
        <translation>%1 / %2 点（機械：%3）：%4。</translation>
    </message>
    <message>
        <source>Click the place</source>
        <translation>場所をクリック</translation>
    </message>
    <message>
        <source>The next click in the picture pins the comment there; in a replay also to that moment</source>
        <translation>画像で次にクリックした場所にコメントを付ける。再生中はその時刻にも付ける</translation>
    </message>
    <message>
        <source>Place chosen: click anew</source>
        <translation>場所を選択済み：選び直す</translation>
    </message>
    <message>
        <source>Return to student...</source>
        <translation>受講者へ返却...</translation>
    </message>
    <message>
        <source>One file with your comments, what you judged otherwise and why, and the score</source>
        <translation>コメント、機械と違う判断とその理由、得点をひとつのファイルにします</translation>
    </message>
    <message>
        <source>The picture does not show this work.</source>
        <translation>画面に出ているのはこの作品ではありません。</translation>
    </message>
    <message>
        <source>Whether the picture shows this work</source>
        <translation>画面に出ているのがこの作品かどうか</translation>
    </message>
    <message>
        <source>It may go in without marks.</source>
        <translation>評価なしで確定できます。</translation>
    </message>
    <message>
        <source>The machine&apos;s score is shown when all works are marked.</source>
        <translation>機械の得点は、すべての作品を評価すると表示されます。</translation>
    </message>
    <message>
        <source>Still to be marked: %1.</source>
        <translation>残り：%1。</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::WorkTable</name>
    <message>
        <source>critical error</source>
        <translation>重大な誤り</translation>
    </message>
    <message>
        <source>borderline</source>
        <translation>境界</translation>
    </message>
    <message>
        <source>unproven</source>
        <translation>未証明</translation>
    </message>
    <message>
        <source>not scored</source>
        <translation>採点不能</translation>
    </message>
    <message>
        <source>passed</source>
        <translation>合格</translation>
    </message>
    <message>
        <source>not passed</source>
        <translation>不合格</translation>
    </message>
    <message>
        <source>the teacher decides</source>
        <translation>教員が判定</translation>
    </message>
    <message>
        <source>%1 of %2</source>
        <translation>%1 / %2</translation>
    </message>
    <message>
        <source>hidden</source>
        <translation>非表示</translation>
    </message>
    <message>
        <source>marked</source>
        <translation>評価済み</translation>
    </message>
    <message>
        <source>to be marked</source>
        <translation>未評価</translation>
    </message>
    <message>
        <source>begun</source>
        <translation>途中</translation>
    </message>
    <message>
        <source>waits for its score</source>
        <translation>採点待ち</translation>
    </message>
    <message>
        <source>the machine&apos;s score is shown at the end</source>
        <translation>機械の得点は最後に表示</translation>
    </message>
    <message>
        <source>came a second time</source>
        <translation>二度目</translation>
    </message>
    <message>
        <source>overridden: %1</source>
        <translation>変更：%1</translation>
    </message>
    <message>
        <source>decided</source>
        <translation>判定済み</translation>
    </message>
    <message>
        <source>Code</source>
        <translation>コード</translation>
    </message>
    <message>
        <source>File</source>
        <translation>ファイル</translation>
    </message>
    <message>
        <source>Score</source>
        <translation>得点</translation>
    </message>
    <message>
        <source>Machine&apos;s score</source>
        <translation>機械の得点</translation>
    </message>
    <message>
        <source>Passed</source>
        <translation>合否</translation>
    </message>
    <message>
        <source>Flags</source>
        <translation>印</translation>
    </message>
    <message>
        <source>State</source>
        <translation>状態</translation>
    </message>
    <message>
        <source>Comments</source>
        <translation>コメント</translation>
    </message>
</context>
<context>
    <name>Assessment</name>
    <message>
        <source>; %1: %2 to %3 %4</source>
        <translation>；%1：%2～%3 %4</translation>
    </message>
    <message>
        <source>; %1: at least %2 %3</source>
        <translation>；%1：%2 %3 以上</translation>
    </message>
    <message>
        <source>; %1: at most %2 %3</source>
        <translation>；%1：%2 %3 以下</translation>
    </message>
    <message>
        <source>%1 (%2 points)</source>
        <translation>%1（%2 点）</translation>
    </message>
    <message>
        <source>; critical error: %1</source>
        <translation>；重大な誤り：%1</translation>
    </message>
    <message>
        <source>Passed</source>
        <translation>合格</translation>
    </message>
    <message>
        <source>Not passed</source>
        <translation>不合格</translation>
    </message>
    <message>
        <source>The teacher decides</source>
        <translation>教員が判断</translation>
    </message>
    <message>
        <source>%1 of %2</source>
        <translation>%1 / %2</translation>
    </message>
    <message>
        <source>even (%1)</source>
        <translation>なめらか（%1）</translation>
    </message>
    <message>
        <source>fairly even (%1)</source>
        <translation>ほぼなめらか（%1）</translation>
    </message>
    <message>
        <source>uneven (%1)</source>
        <translation>ぎこちない（%1）</translation>
    </message>
    <message>
        <source>%1:%2 min</source>
        <translation>%1 分 %2 秒</translation>
    </message>
    <message>
        <source>not judged with this device</source>
        <translation>この機器では採点しない</translation>
    </message>
    <message>
        <source>critical error</source>
        <translation>重大な誤り</translation>
    </message>
    <message>
        <source>at the border, within ± %1: the teacher decides</source>
        <translation>境界上（± %1 以内）：教員が判断</translation>
    </message>
    <message>
        <source>%1 points times %2: the work is not finished</source>
        <translation>%1 点 × %2：未完成のため</translation>
    </message>
    <message>
        <source>not measured</source>
        <translation>測定できず</translation>
    </message>
    <message>
        <source>not counted</source>
        <translation>数えない</translation>
    </message>
    <message>
        <source>%1: %2</source>
        <translation>%1：%2</translation>
    </message>
    <message>
        <source>%1: %2, asked: %3</source>
        <translation>%1：%2、求められる値：%3</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ExercisesDialog</name>
    <message>
        <source>beginner</source>
        <translation>初級</translation>
    </message>
    <message>
        <source>basic</source>
        <translation>基礎</translation>
    </message>
    <message>
        <source>intermediate</source>
        <translation>中級</translation>
    </message>
    <message>
        <source>advanced</source>
        <translation>上級</translation>
    </message>
    <message>
        <source>Exercises</source>
        <translation>課題</translation>
    </message>
    <message>
        <source>Preparing what is shown</source>
        <translation>表示を準備しています</translation>
    </message>
    <message>
        <source>Begin</source>
        <translation>始める</translation>
    </message>
    <message>
        <source>Open the tooth of this exercise and work on it</source>
        <translation>この課題の歯を開いて作業を始めます</translation>
    </message>
    <message>
        <source>Folder...</source>
        <translation>フォルダー...</translation>
    </message>
    <message>
        <source>Choose a folder with exercises of your school</source>
        <translation>学校の課題があるフォルダーを選びます</translation>
    </message>
    <message>
        <source>Title of the exercise</source>
        <translation>課題の題名</translation>
    </message>
    <message>
        <source>What to do</source>
        <translation>内容</translation>
    </message>
    <message>
        <source>Tooth, bur and helps</source>
        <translation>歯、バー、使える補助</translation>
    </message>
    <message>
        <source>Best so far</source>
        <translation>これまでの最高点</translation>
    </message>
    <message>
        <source>What is judged</source>
        <translation>採点の項目</translation>
    </message>
    <message>
        <source>What is wrong</source>
        <translation>問題点</translation>
    </message>
    <message>
        <source>Those of the program.</source>
        <translation>プログラムに付属の課題です。</translation>
    </message>
    <message>
        <source>And those in %1</source>
        <translation>付属の課題と、%1 にある課題です。</translation>
    </message>
    <message>
        <source>Reading the folder</source>
        <translation>フォルダーを読み込んでいます</translation>
    </message>
    <message>
        <source>Opening the exercise</source>
        <translation>課題を開いています</translation>
    </message>
    <message>
        <source>Cutting the ideal</source>
        <translation>理想形を削っています</translation>
    </message>
    <message>
        <source>The ideal: drag to turn it</source>
        <translation>理想形：ドラッグで回転</translation>
    </message>
    <message>
        <source>Tooth %1</source>
        <translation>歯 %1</translation>
    </message>
    <message>
        <source>%1 minutes</source>
        <translation>%1 分</translation>
    </message>
    <message>
        <source>Burs: %1</source>
        <translation>バー：%1</translation>
    </message>
    <message>
        <source>Bur to begin with: %1</source>
        <translation>最初のバー：%1</translation>
    </message>
    <message>
        <source>Drive to begin with: %1</source>
        <translation>最初の駆動方式：%1</translation>
    </message>
    <message>
        <source>Not in this exercise: %1</source>
        <translation>この課題では使えないもの: %1</translation>
    </message>
    <message>
        <source>Not tried yet.</source>
        <translation>まだ試していません。</translation>
    </message>
    <message>
        <source>This exercise is not judged: it has no rubric.</source>
        <translation>この課題にはルーブリックがなく、採点されません。</translation>
    </message>
    <message>
        <source>Without helps</source>
        <translation>補助なしで</translation>
    </message>
    <message>
        <source>Show what was lost once more, by yourself: no depth, no section, no glass</source>
        <translation>失点した項目を、深さ表示・断面・半透明表示なしで、もう一度自力で行います</translation>
    </message>
    <message>
        <source>Due</source>
        <translation>再確認</translation>
    </message>
    <message>
        <source>Due once more, without helps: %1</source>
        <translation>補助なしの再確認：%1</translation>
    </message>
    <message>
        <source>Next step</source>
        <translation>次の課題</translation>
    </message>
    <message>
        <source>The first in the list that is not passed yet</source>
        <translation>一覧のうち、まだ合格していない最初の課題</translation>
    </message>
    <message>
        <source>Next step: %1</source>
        <translation>次の課題：%1</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::PracticeFeature</name>
    <message>
        <source>Drawing the section</source>
        <translation>断面を描いています</translation>
    </message>
    <message>
        <source>A folder with exercises</source>
        <translation>課題のフォルダー</translation>
    </message>
    <message>
        <source>Cutting the ideal</source>
        <translation>理想形を削っています</translation>
    </message>
    <message>
        <source>Save the result</source>
        <translation>結果を保存</translation>
    </message>
    <message>
        <source>Page (*.html)</source>
        <translation>ページ (*.html)</translation>
    </message>
    <message>
        <source>Writing the page</source>
        <translation>ページを書き出しています</translation>
    </message>
    <message>
        <source>Opening the result</source>
        <translation>結果を開いています</translation>
    </message>
    <message>
        <source>Marks from your teacher</source>
        <translation>先生からの評価</translation>
    </message>
    <message>
        <source>Marks (*.json);;All files (*)</source>
        <translation>評価 (*.json);;すべてのファイル (*)</translation>
    </message>
    <message>
        <source>Looking into your teacher&apos;s work</source>
        <translation>先生の作業を調べています</translation>
    </message>
    <message>
        <source>Written: %1</source>
        <translation>書き込みました: %1</translation>
    </message>
    <message>
        <source>Hand in</source>
        <translation>提出</translation>
    </message>
    <message>
        <source>Attempt with its tooth (*.handpiece)</source>
        <translation>作業と歯 (*.handpiece)</translation>
    </message>
    <message>
        <source>Handed in: %1, with its tooth. Recordings in it: %2. Give this file to your teacher.</source>
        <translation>提出用ファイル: %1（歯を含む）。含まれる記録: %2。このファイルを先生に渡してください。</translation>
    </message>
    <message>
        <source>Handed in: %1, with its tooth. No recordings are in it, because one of them is missing. Give this file to your teacher.</source>
        <translation>提出用ファイル: %1（歯を含む）。記録のひとつが欠けているため、記録は含まれていません。このファイルを先生に渡してください。</translation>
    </message>
    <message>
        <source>Handing in</source>
        <translation>提出しています</translation>
    </message>
    <message>
        <source>Back to the result</source>
        <translation>結果に戻る</translation>
    </message>
    <message>
        <source>The ideal is being cut: it can be chosen in some seconds.</source>
        <translation>理想形を削っています。数秒後に選べます。</translation>
    </message>
    <message>
        <source>This exercise asks for no preparation: there is no ideal.</source>
        <translation>この課題は形成を求めていないので、理想形はありません。</translation>
    </message>
    <message>
        <source>The ideal cannot be shown. %1</source>
        <translation>理想形を表示できません。%1</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ProgressCurve</name>
    <message>
        <source>Share of all points over the attempts</source>
        <translation>回を追った得点率</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ProgressDialog</name>
    <message>
        <source>Exercise</source>
        <translation>課題</translation>
    </message>
    <message>
        <source>Attempts</source>
        <translation>試行</translation>
    </message>
    <message>
        <source>Progress</source>
        <translation>上達の記録</translation>
    </message>
    <message>
        <source>When</source>
        <translation>日時</translation>
    </message>
    <message>
        <source>Score</source>
        <translation>得点</translation>
    </message>
    <message>
        <source>Passed</source>
        <translation>合格</translation>
    </message>
    <message>
        <source>Device</source>
        <translation>デバイス</translation>
    </message>
    <message>
        <source>Proven</source>
        <translation>検証済み</translation>
    </message>
    <message>
        <source>No exercise is finished yet.</source>
        <translation>終えた課題はまだありません。</translation>
    </message>
    <message>
        <source>Attempts with another device, motion scale or version of the exercise are not compared: each has a line of its own.</source>
        <translation>デバイス、動きの倍率、課題の版が違う試行は比べられません。それぞれ別の線で示します。</translation>
    </message>
    <message>
        <source>%1 (%2 %)</source>
        <translation>%1（%2 %）</translation>
    </message>
    <message>
        <source>yes</source>
        <translation>はい</translation>
    </message>
    <message>
        <source>no</source>
        <translation>いいえ</translation>
    </message>
    <message>
        <source>Hollow: not all of it could be measured; its share says nothing about the rest.</source>
        <translation>白抜き：一部を測定できませんでした。残りについては何も言えません。</translation>
    </message>
    <message>
        <source>%1 (%2 %), in part</source>
        <translation>%1（%2 %）、一部のみ</translation>
    </message>
    <message>
        <source>Time</source>
        <translation>時間</translation>
    </message>
    <message>
        <source>Open the result</source>
        <translation>結果を開く</translation>
    </message>
    <message>
        <source>See it again: why, the page, and the seconds where its recording is kept</source>
        <translation>理由、印刷用のページ、記録が残っていればその場面を、もう一度見られます</translation>
    </message>
    <message>
        <source>%1, over by %2</source>
        <translation>%1、超過 %2</translation>
    </message>
    <message>
        <source>Hand in...</source>
        <translation>提出...</translation>
    </message>
    <message>
        <source>One file for your teacher, as long as its recordings are kept</source>
        <translation>先生に渡すひとつのファイル。記録が残っている間に限ります</translation>
    </message>
    <message>
        <source>Marks from your teacher...</source>
        <translation>先生からの評価...</translation>
    </message>
    <message>
        <source>Open the file that your teacher gave back: comments and points</source>
        <translation>先生が返却したファイルを開きます。コメントと点数が入っています</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ResultDialog</name>
    <message>
        <source>Result</source>
        <translation>結果</translation>
    </message>
    <message>
        <source>Before you see the result: what do you think of your own work?</source>
        <translation>結果を見る前に、自分の作業をどう評価しますか？</translation>
    </message>
    <message>
        <source>Of all points I expect</source>
        <translation>予想する得点率</translation>
    </message>
    <message>
        <source> %</source>
        <translation> %</translation>
    </message>
    <message>
        <source>What went well, and what would you do otherwise?</source>
        <translation>うまくいった点と、次に変えたい点</translation>
    </message>
    <message>
        <source>Show the result</source>
        <translation>結果を見る</translation>
    </message>
    <message>
        <source>Exercise</source>
        <translation>課題</translation>
    </message>
    <message>
        <source>Score</source>
        <translation>得点</translation>
    </message>
    <message>
        <source>Why</source>
        <translation>理由</translation>
    </message>
    <message>
        <source>Your own judgement</source>
        <translation>自己評価</translation>
    </message>
    <message>
        <source>All that was judged</source>
        <translation>採点のすべて</translation>
    </message>
    <message>
        <source>A click on a row with a place turns the eye there and plays the seconds in which it happened</source>
        <translation>場所のある行をクリックすると、視点をそこに向け、起きた数秒を再生します</translation>
    </message>
    <message>
        <source>Points</source>
        <translation>点</translation>
    </message>
    <message>
        <source>Your tooth</source>
        <translation>自分の歯</translation>
    </message>
    <message>
        <source>The ideal</source>
        <translation>理想形</translation>
    </message>
    <message>
        <source>Save as a page...</source>
        <translation>ページとして保存...</translation>
    </message>
    <message>
        <source>One HTML page to keep or to print</source>
        <translation>保存や印刷のためのページ 1 枚</translation>
    </message>
    <message>
        <source>Again</source>
        <translation>もう一度</translation>
    </message>
    <message>
        <source>Begin the same exercise anew</source>
        <translation>同じ課題を最初から始めます</translation>
    </message>
    <message>
        <source>Next</source>
        <translation>次へ</translation>
    </message>
    <message>
        <source>Choose the next exercise</source>
        <translation>次の課題を選びます</translation>
    </message>
    <message>
        <source>%1 points (%2 to %3): %4</source>
        <translation>%1 点（%2～%3）：%4</translation>
    </message>
    <message>
        <source>Perhaps a critical error: %1</source>
        <translation>重大な誤りの可能性：%1</translation>
    </message>
    <message>
        <source>Critical error: %1</source>
        <translation>重大な誤り：%1</translation>
    </message>
    <message>
        <source>Criteria worth %1 of %2 points could not be measured.</source>
        <translation>%2 点のうち %1 点分の項目は測定できませんでした。</translation>
    </message>
    <message>
        <source>You expected %1 %; it is %2 %.</source>
        <translation>予想は %1 %、結果は %2 % です。</translation>
    </message>
    <message>
        <source>Proven: cut again from its recording it is the same tooth, bit for bit.</source>
        <translation>検証済み：記録から削り直すと、まったく同じ歯になります。</translation>
    </message>
    <message>
        <source>What cost most</source>
        <translation>最も減点された項目</translation>
    </message>
    <message>
        <source>%1 points lost</source>
        <translation>%1 点の減点</translation>
    </message>
    <message>
        <source>Show</source>
        <translation>表示</translation>
    </message>
    <message>
        <source>Turn the eye there and play the seconds in which it happened</source>
        <translation>視点をそこに向け、起きた数秒を再生します</translation>
    </message>
    <message>
        <source>Turn the eye there</source>
        <translation>視点をそこに向けます</translation>
    </message>
    <message>
        <source>shown only</source>
        <translation>表示のみ</translation>
    </message>
    <message>
        <source>The ideal: drag to turn it</source>
        <translation>理想形：ドラッグで回転</translation>
    </message>
    <message>
        <source>Your tooth: drag to turn it</source>
        <translation>自分の歯：ドラッグで回転</translation>
    </message>
    <message>
        <source>Time</source>
        <translation>時間</translation>
    </message>
    <message>
        <source>Your teacher&apos;s comments</source>
        <translation>先生のコメント</translation>
    </message>
    <message>
        <source>A click on a comment turns the eye to its place and plays its seconds</source>
        <translation>コメントをクリックすると、その場所に視点を向け、その場面を再生します</translation>
    </message>
    <message>
        <source>(%1 s)</source>
        <translation>（%1 秒）</translation>
    </message>
    <message>
        <source>Time: %1 of %2</source>
        <translation>時間：%1 / %2</translation>
    </message>
    <message>
        <source>Time: %1 of %2, over by %3</source>
        <translation>時間：%1 / %2、超過 %3</translation>
    </message>
    <message>
        <source>Not proven: the recording does not lead to this very tooth. %1</source>
        <translation>証明できません：記録をたどってもこの歯になりません。%1</translation>
    </message>
    <message>
        <source>Its recording is no longer kept: the tooth cannot be shown</source>
        <translation>記録が残っていないため、歯を表示できません</translation>
    </message>
    <message>
        <source>What your teacher says</source>
        <translation>先生の評価</translation>
    </message>
    <message>
        <source>Hand in...</source>
        <translation>提出...</translation>
    </message>
    <message>
        <source>One file for your teacher: the tooth, all that was recorded, the result, and what you expected</source>
        <translation>先生に渡すひとつのファイル: 歯、すべての記録、結果、自分の予想</translation>
    </message>
    <message>
        <source>Teacher&apos;s work</source>
        <translation>先生の作業</translation>
    </message>
    <message>
        <source>Play your teacher&apos;s own work on the same tooth: the seconds at the place that you looked at last, or from its beginning</source>
        <translation>同じ歯での先生自身の作業を再生します。最後に見た場所を削った数秒、または最初から</translation>
    </message>
    <message>
        <source>%1 points</source>
        <translation>%1 点</translation>
    </message>
    <message>
        <source>critical error</source>
        <translation>重大な誤り</translation>
    </message>
    <message>
        <source>%1: %2. %3</source>
        <translation>%1：%2。%3</translation>
    </message>
    <message>
        <source>%1: %2</source>
        <translation>%1：%2</translation>
    </message>
    <message>
        <source>%1: %2 points: %3</source>
        <translation>%1：%2 点、%3</translation>
    </message>
    <message>
        <source>(by another rubric, %1)</source>
        <translation>（別の評価基準 %1 による）</translation>
    </message>
    <message>
        <source>What was judged</source>
        <translation>採点項目</translation>
    </message>
    <message>
        <source>Yours</source>
        <translation>自分の値</translation>
    </message>
    <message>
        <source>Asked</source>
        <translation>求められる値</translation>
    </message>
    <message>
        <source>Why not all points</source>
        <translation>満点でない理由</translation>
    </message>
    <message>
        <source>Practise</source>
        <translation>練習する</translation>
    </message>
    <message>
        <source>Open the exercise that trains this: %1</source>
        <translation>これを練習する課題を開きます：%1</translation>
    </message>
    <message>
        <source>Most is still to be cut here.</source>
        <translation>ここに最も多く残っています。</translation>
    </message>
    <message>
        <source>asked: %1</source>
        <translation>求められる値：%1</translation>
    </message>
    <message>
        <source>A click shows where</source>
        <translation>クリックすると場所を示します</translation>
    </message>
</context>
<context>
    <name>Preparation</name>
    <message>
        <source>Endodontic access cavity</source>
        <translation>髄室開拡</translation>
    </message>
    <message>
        <source>Block: channel</source>
        <translation>ブロック：溝</translation>
    </message>
    <message>
        <source>Block: circle</source>
        <translation>ブロック：円</translation>
    </message>
    <message>
        <source>Block: cross</source>
        <translation>ブロック：十字</translation>
    </message>
    <message>
        <source>Block: half circle</source>
        <translation>ブロック：半円</translation>
    </message>
    <message>
        <source>Block: ring</source>
        <translation>ブロック：輪</translation>
    </message>
    <message>
        <source>Block: line</source>
        <translation>ブロック：直線</translation>
    </message>
    <message>
        <source>Block: steps</source>
        <translation>ブロック：段</translation>
    </message>
    <message>
        <source>Class V cavity</source>
        <translation>5 級窩洞</translation>
    </message>
    <message>
        <source>Class I cavity</source>
        <translation>1 級窩洞</translation>
    </message>
    <message>
        <source>Class III cavity</source>
        <translation>3 級窩洞</translation>
    </message>
    <message>
        <source>Class II cavity</source>
        <translation>2 級窩洞</translation>
    </message>
    <message>
        <source>Full crown</source>
        <translation>全部被覆冠</translation>
    </message>
    <message>
        <source>Removal of carious tissue</source>
        <translation>う蝕除去</translation>
    </message>
    <message>
        <source>As painted</source>
        <translation>塗った範囲のとおり</translation>
    </message>
    <message>
        <source>As in recorded work</source>
        <translation>記録した形成のとおり</translation>
    </message>
    <message>
        <source>Depth</source>
        <translation>深さ</translation>
    </message>
    <message>
        <source>Width</source>
        <translation>幅</translation>
    </message>
    <message>
        <source>Height, incisogingivally</source>
        <translation>高さ（切縁歯肉方向）</translation>
    </message>
    <message>
        <source>Length</source>
        <translation>長さ</translation>
    </message>
    <message>
        <source>Diameter</source>
        <translation>直径</translation>
    </message>
    <message>
        <source>Diameter of the island</source>
        <translation>中央に残す部分の直径</translation>
    </message>
    <message>
        <source>Left of marginal ridges and walls</source>
        <translation>残す辺縁隆線と側壁の厚さ</translation>
    </message>
    <message>
        <source>Wall angle</source>
        <translation>側壁の角度</translation>
    </message>
    <message>
        <source>Axial depth</source>
        <translation>軸側の深さ</translation>
    </message>
    <message>
        <source>Width of the box</source>
        <translation>ボックスの幅</translation>
    </message>
    <message>
        <source>Gingival floor under the contact</source>
        <translation>接触点から歯肉側窩壁まで</translation>
    </message>
    <message>
        <source>Radius of the corners</source>
        <translation>隅角の半径</translation>
    </message>
    <message>
        <source>Over the cemento-enamel junction</source>
        <translation>セメント・エナメル境からの高さ</translation>
    </message>
    <message>
        <source>Occlusal reduction</source>
        <translation>咬合面の削除量</translation>
    </message>
    <message>
        <source>Width of the margin</source>
        <translation>マージンの幅</translation>
    </message>
    <message>
        <source>Total occlusal convergence</source>
        <translation>咬合面方向への収束角</translation>
    </message>
    <message>
        <source>Round horns and orifices</source>
        <translation>髄角と根管口の周囲</translation>
    </message>
    <message>
        <source>Carious tissue left over the pulp</source>
        <translation>歯髄の上に残すう蝕の厚さ</translation>
    </message>
    <message>
        <source>Title of the rubric</source>
        <translation>ルーブリックの題</translation>
    </message>
    <message>
        <source>About the rubric</source>
        <translation>ルーブリックの説明</translation>
    </message>
    <message>
        <source>Band %1</source>
        <translation>区分 %1</translation>
    </message>
    <message>
        <source>Step %1</source>
        <translation>段階 %1</translation>
    </message>
    <message>
        <source>Criterion %1</source>
        <translation>項目 %1</translation>
    </message>
    <message>
        <source>%1: what it is about</source>
        <translation>%1：内容</translation>
    </message>
    <message>
        <source>%1: what it leaves out</source>
        <translation>%1：含まないもの</translation>
    </message>
    <message>
        <source>%1: its critical error</source>
        <translation>%1：重大な誤り</translation>
    </message>
    <message>
        <source>Rule %1</source>
        <translation>規則 %1</translation>
    </message>
    <message>
        <source>Kept of the labial surface</source>
        <translation>唇側面に残す厚さ</translation>
    </message>
    <message>
        <source>Onlay</source>
        <translation>アンレー</translation>
    </message>
    <message>
        <source>Axial depth of the other box</source>
        <translation>反対側のボックスの軸側の深さ</translation>
    </message>
    <message>
        <source>Off the mesiobuccal cusp</source>
        <translation>近心頬側咬頭の削除量</translation>
    </message>
    <message>
        <source>Off the distobuccal cusp</source>
        <translation>遠心頬側咬頭の削除量</translation>
    </message>
    <message>
        <source>Off the mesiolingual cusp</source>
        <translation>近心舌側咬頭の削除量</translation>
    </message>
    <message>
        <source>Off the distolingual cusp</source>
        <translation>遠心舌側咬頭の削除量</translation>
    </message>
    <message>
        <source>Shoulder under the capped cusps</source>
        <translation>被覆咬頭の下のショルダーまで</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::EditorDialog</name>
    <message>
        <source>Error</source>
        <translation>エラー</translation>
    </message>
    <message>
        <source>Warning</source>
        <translation>警告</translation>
    </message>
    <message>
        <source>Remark</source>
        <translation>注記</translation>
    </message>
    <message>
        <source>Parts of the exercise</source>
        <translation>課題の構成</translation>
    </message>
    <message>
        <source>Tooth</source>
        <translation>歯</translation>
    </message>
    <message>
        <source>Preparation</source>
        <translation>形成</translation>
    </message>
    <message>
        <source>Work</source>
        <translation>作業</translation>
    </message>
    <message>
        <source>Judgement</source>
        <translation>評価</translation>
    </message>
    <message>
        <source>Texts</source>
        <translation>文章</translation>
    </message>
    <message>
        <source>What is wrong</source>
        <translation>問題点</translation>
    </message>
    <message>
        <source>A click goes to its page</source>
        <translation>クリックするとそのページへ移ります</translation>
    </message>
    <message>
        <source>Undo</source>
        <translation>元に戻す</translation>
    </message>
    <message>
        <source>Take the last change back</source>
        <translation>最後の変更を取り消します</translation>
    </message>
    <message>
        <source>Redo</source>
        <translation>やり直す</translation>
    </message>
    <message>
        <source>Make it again</source>
        <translation>もう一度行います</translation>
    </message>
    <message>
        <source>Try it</source>
        <translation>試す</translation>
    </message>
    <message>
        <source>Open it in the window as a student would have it</source>
        <translation>学生が見るのと同じ形で、ウィンドウに開きます</translation>
    </message>
    <message>
        <source>Save</source>
        <translation>保存</translation>
    </message>
    <message>
        <source>Save the exercise where it is</source>
        <translation>課題を今の場所に保存します</translation>
    </message>
    <message>
        <source>Save as .handpiece...</source>
        <translation>.handpiece として保存...</translation>
    </message>
    <message>
        <source>One file to give to students</source>
        <translation>学生に渡す 1 つのファイル</translation>
    </message>
    <message>
        <source>Exercise editor: %1</source>
        <translation>課題エディター：%1</translation>
    </message>
    <message>
        <source>Laying the preparation on the tooth...</source>
        <translation>形成を歯に当てはめています...</translation>
    </message>
    <message>
        <source>Students cannot have it like this yet.</source>
        <translation>このままでは学生に渡せません。</translation>
    </message>
    <message>
        <source>Nothing stands in the way.</source>
        <translation>問題はありません。</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::EditorFeature</name>
    <message>
        <source>Exercise editor</source>
        <translation>課題エディター</translation>
    </message>
    <message>
        <source>The exercise was changed, and no file holds it.</source>
        <translation>課題は変更されましたが、まだ保存されていません。</translation>
    </message>
    <message>
        <source>Save</source>
        <translation>保存</translation>
    </message>
    <message>
        <source>Do not save</source>
        <translation>保存しない</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>キャンセル</translation>
    </message>
    <message>
        <source>Making the block...</source>
        <translation>ブロックを作っています...</translation>
    </message>
    <message>
        <source>Edit exercise</source>
        <translation>課題を編集</translation>
    </message>
    <message>
        <source>Exercises (*.handpiece exercise.toml);;All files (*)</source>
        <translation>課題 (*.handpiece exercise.toml);;すべてのファイル (*)</translation>
    </message>
    <message>
        <source>Making the tooth...</source>
        <translation>歯を作っています...</translation>
    </message>
    <message>
        <source>Case of the exercise</source>
        <translation>課題の症例</translation>
    </message>
    <message>
        <source>Cases (*.handpiece case.toml);;All files (*)</source>
        <translation>症例 (*.handpiece case.toml);;すべてのファイル (*)</translation>
    </message>
    <message>
        <source>Reading the case...</source>
        <translation>症例を読み込んでいます...</translation>
    </message>
    <message>
        <source>Save the exercise</source>
        <translation>課題を保存</translation>
    </message>
    <message>
        <source>Exercise (*.handpiece)</source>
        <translation>課題 (*.handpiece)</translation>
    </message>
    <message>
        <source>Your own work</source>
        <translation>自分の作業</translation>
    </message>
    <message>
        <source>Recordings (*.h5);;All files (*)</source>
        <translation>記録 (*.h5);;すべてのファイル (*)</translation>
    </message>
    <message>
        <source>It is cut again...</source>
        <translation>切削し直しています...</translation>
    </message>
    <message>
        <source>Work that becomes the target</source>
        <translation>目標にする形成</translation>
    </message>
    <message>
        <source>Attempts and sessions (*.handpiece *.h5);;All files (*)</source>
        <translation>作業と記録 (*.handpiece *.h5);;すべてのファイル (*)</translation>
    </message>
    <message>
        <source>Reading the work...</source>
        <translation>形成を読み込み中...</translation>
    </message>
    <message>
        <source>%1 of %2 points</source>
        <translation>%1／%2点</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::PreparationPage</name>
    <message>
        <source>Cuts the tooth as the preparation asks for it; takes seconds</source>
        <translation>形成の指示どおりに歯を削って見せます。数秒かかります</translation>
    </message>
    <message>
        <source>Preparation</source>
        <translation>形成</translation>
    </message>
    <message>
        <source>Nothing is asked</source>
        <translation>形成は求めない</translation>
    </message>
    <message>
        <source>Side</source>
        <translation>面</translation>
    </message>
    <message>
        <source>mesial</source>
        <translation>近心</translation>
    </message>
    <message>
        <source>distal</source>
        <translation>遠心</translation>
    </message>
    <message>
        <source>What may go beside it</source>
        <translation>目標のほかに削ってよい範囲</translation>
    </message>
    <message>
        <source>At the sides</source>
        <translation>側方</translation>
    </message>
    <message>
        <source>Past the walls of the target</source>
        <translation>目標の側壁より外側</translation>
    </message>
    <message>
        <source>Under the floor</source>
        <translation>窩底の下</translation>
    </message>
    <message>
        <source>Deeper than the target</source>
        <translation>目標より深い部分</translation>
    </message>
    <message>
        <source>Kept over the pulp</source>
        <translation>歯髄の上に残す厚さ</translation>
    </message>
    <message>
        <source>All within this of the pulp must stay; 0: the pulp alone</source>
        <translation>歯髄からこの距離以内はすべて残します。0 は歯髄だけ</translation>
    </message>
    <message>
        <source>%1 to %2, usually %3</source>
        <translation>%1～%2、通常 %3</translation>
    </message>
    <message>
        <source>Cutting the ideal...</source>
        <translation>理想形を削っています...</translation>
    </message>
    <message>
        <source>As it is asked for: drag to turn it</source>
        <translation>課題が求める形：ドラッグして回せます</translation>
    </message>
    <message>
        <source>The tooth with its preparation</source>
        <translation>形成を重ねた歯</translation>
    </message>
    <message>
        <source>Drag a handle: its number follows; Escape gives it up. Drag elsewhere: turn. Right button: shift. Wheel: nearer.</source>
        <translation>ハンドルをドラッグ：数値が変わる（Esc で取りやめ）。ほかの所をドラッグ：回転。右ボタン：移動。ホイール：拡大。</translation>
    </message>
    <message>
        <source>Cut it out</source>
        <translation>切削して見る</translation>
    </message>
    <message>
        <source>%1: %2 %3</source>
        <translation>%1：%2 %3</translation>
    </message>
    <message>
        <source>Green is to go, orange must stay: drag a white handle to change a number</source>
        <translation>緑は切削、橙は保存：白いハンドルをドラッグして数値を変える</translation>
    </message>
    <message>
        <source>Choose a tooth first</source>
        <translation>先に歯を選ぶ</translation>
    </message>
    <message>
        <source>Laying the preparation on the tooth...</source>
        <translation>形成を歯に重ねています...</translation>
    </message>
    <message>
        <source>Choose a preparation</source>
        <translation>形成を選ぶ</translation>
    </message>
    <message>
        <source>Back to its numbers</source>
        <translation>数値に戻る</translation>
    </message>
    <message>
        <source>Green is to go, orange must stay: paint on with the left button</source>
        <translation>緑は削る部分、橙は残す部分：左ボタンで続けて塗る</translation>
    </message>
    <message>
        <source>Green is to go, orange must stay</source>
        <translation>緑は削る部分、橙は残す部分</translation>
    </message>
    <message>
        <source>Paint on the tooth with the left button</source>
        <translation>左ボタンで歯の上を塗る</translation>
    </message>
    <message>
        <source>Take the work whose cut is the target</source>
        <translation>切削が目標となる形成を取り込む</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::OwnTarget</name>
    <message>
        <source>Take work...</source>
        <translation>形成を取り込む...</translation>
    </message>
    <message>
        <source>Take work</source>
        <translation>形成を取り込む</translation>
    </message>
    <message>
        <source>A session or an attempt: what was cut in it is the target, in the voxel it was cut in</source>
        <translation>記録または保存した作業：そこで切削された部分が、切削時のボクセルのまま目標になる</translation>
    </message>
    <message>
        <source>Judged as</source>
        <translation>評価の種類</translation>
    </message>
    <message>
        <source>Says how it is measured, and which rubric comes along</source>
        <translation>測定の方法と、付属するルーブリックを決める</translation>
    </message>
    <message>
        <source>nothing of these</source>
        <translation>いずれでもない</translation>
    </message>
    <message>
        <source>Left button</source>
        <translation>左ボタン</translation>
    </message>
    <message>
        <source>On the tooth; beside it: turn</source>
        <translation>歯の上での働き。歯の外では回転</translation>
    </message>
    <message>
        <source>paints</source>
        <translation>塗る</translation>
    </message>
    <message>
        <source>erases</source>
        <translation>消す</translation>
    </message>
    <message>
        <source>turns the tooth</source>
        <translation>歯を回転する</translation>
    </message>
    <message>
        <source>Radius of the brush</source>
        <translation>ブラシの半径</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::RubricPage</name>
    <message>
        <source>A rubric that comes along</source>
        <translation>付属のルーブリック</translation>
    </message>
    <message>
        <source>Take this rubric</source>
        <translation>このルーブリックを使う</translation>
    </message>
    <message>
        <source>In the place of the one that is there; Undo brings that back</source>
        <translation>今のものと置き換えます。「元に戻す」で戻せます</translation>
    </message>
    <message>
        <source>Not judged</source>
        <translation>評価しない</translation>
    </message>
    <message>
        <source>Add criterion</source>
        <translation>項目を追加</translation>
    </message>
    <message>
        <source>Remove</source>
        <translation>削除</translation>
    </message>
    <message>
        <source>Up</source>
        <translation>上へ</translation>
    </message>
    <message>
        <source>Down</source>
        <translation>下へ</translation>
    </message>
    <message>
        <source>Pass from</source>
        <translation>合格は</translation>
    </message>
    <message>
        <source>There is a pass mark</source>
        <translation>合格点を設ける</translation>
    </message>
    <message>
        <source>Pass mark</source>
        <translation>合格点</translation>
    </message>
    <message>
        <source>Of the greatest score</source>
        <translation>満点に対する割合</translation>
    </message>
    <message>
        <source>Criteria</source>
        <translation>評価項目</translation>
    </message>
    <message>
        <source>Points: value: points, from 0 to 100, straight between. Bands: name from..to; ... Critical: &lt; or &gt;</source>
        <translation>得点は「値: 点」（0～100、間は直線）。区分は「名前 下限..上限; ...」。重大な誤りは &lt; か &gt;</translation>
    </message>
    <message>
        <source>Criterion</source>
        <translation>項目</translation>
    </message>
    <message>
        <source>Measure</source>
        <translation>計測</translation>
    </message>
    <message>
        <source>Of</source>
        <translation>対象</translation>
    </message>
    <message>
        <source>Unit</source>
        <translation>単位</translation>
    </message>
    <message>
        <source>Points (value: points)</source>
        <translation>得点（値: 点）</translation>
    </message>
    <message>
        <source>Bands</source>
        <translation>区分</translation>
    </message>
    <message>
        <source>Weight</source>
        <translation>配点</translation>
    </message>
    <message>
        <source>Critical</source>
        <translation>重大な誤り</translation>
    </message>
    <message>
        <source>English</source>
        <translation>英語</translation>
    </message>
    <message>
        <source>Japanese</source>
        <translation>日本語</translation>
    </message>
    <message>
        <source>To mend</source>
        <translation>直すところ</translation>
    </message>
    <message>
        <source>Weights: %1</source>
        <translation>配点の合計：%1</translation>
    </message>
    <message>
        <source>It is not judged: take a rubric that comes along.</source>
        <translation>評価されません。付属のルーブリックを選んでください。</translation>
    </message>
    <message>
        <source>Parts of the rubric</source>
        <translation>ルーブリックの部分</translation>
    </message>
    <message>
        <source>Bands, steps, rules</source>
        <translation>区分・段階・規則</translation>
    </message>
    <message>
        <source>Words</source>
        <translation>言葉</translation>
    </message>
    <message>
        <source>Only for</source>
        <translation>対象の装置</translation>
    </message>
    <message>
        <source>Devices that it is valid for: &lt;code&gt;pointer, falcon&lt;/code&gt;; none: all</source>
        <translation>有効な装置：&lt;code&gt;pointer, falcon&lt;/code&gt;。空：すべて</translation>
    </message>
    <message>
        <source>Makes void</source>
        <translation>無効にする項目</translation>
    </message>
    <message>
        <source>Criteria that do not count where this one fails</source>
        <translation>この項目が不可のとき数えない項目</translation>
    </message>
    <message>
        <source>Its figures are</source>
        <translation>数値の根拠</translation>
    </message>
    <message>
        <source>as the rubric&apos;s</source>
        <translation>ルーブリックに同じ</translation>
    </message>
    <message>
        <source>Source</source>
        <translation>出典</translation>
    </message>
    <message>
        <source>Where the figures are from</source>
        <translation>数値の出典</translation>
    </message>
    <message>
        <source>Short name</source>
        <translation>短い名前</translation>
    </message>
    <message>
        <source>Small letters, digits, &apos;-&apos;, &apos;.&apos;</source>
        <translation>半角の小文字、数字、「-」、「.」</translation>
    </message>
    <message>
        <source>Version</source>
        <translation>版</translation>
    </message>
    <message>
        <source>Another one with each change to be told apart</source>
        <translation>区別したい変更ごとに変える</translation>
    </message>
    <message>
        <source>Weights sum to</source>
        <translation>配点の合計</translation>
    </message>
    <message>
        <source>A check against slips; empty: none</source>
        <translation>誤りを防ぐための確認。空：なし</translation>
    </message>
    <message>
        <source>How far it is done</source>
        <translation>完成度</translation>
    </message>
    <message>
        <source>Target removed in % and the factor of all points, as in 0: 0, 50: 0.5, 70: 1; empty: all points count however little is done</source>
        <translation>目標の切削率（%）と全得点に掛ける係数。例：0: 0, 50: 0.5, 70: 1。空：どれほど少なくても得点をそのまま数える</translation>
    </message>
    <message>
        <source>Bands, from best to worst</source>
        <translation>区分（よい順）</translation>
    </message>
    <message>
        <source>Name</source>
        <translation>名前</translation>
    </message>
    <message>
        <source>Steps, in the order of the work</source>
        <translation>段階（作業の順）</translation>
    </message>
    <message>
        <source>Rules</source>
        <translation>規則</translation>
    </message>
    <message>
        <source>yes</source>
        <translation>はい</translation>
    </message>
    <message>
        <source>no</source>
        <translation>いいえ</translation>
    </message>
    <message>
        <source>Needs</source>
        <translation>条件</translation>
    </message>
    <message>
        <source>To pass</source>
        <translation>合格に必要</translation>
    </message>
    <message>
        <source>Else at most [%]</source>
        <translation>満たさないときの上限 [%]</translation>
    </message>
    <message>
        <source>Needs: bands, then of which criteria, then how many: &lt;code&gt;unacceptable most 0; modify of depth, outline most 2; rule other&lt;/code&gt;</source>
        <translation>条件：区分、対象の項目、数の順：&lt;code&gt;unacceptable most 0; modify of depth, outline most 2; rule other&lt;/code&gt;</translation>
    </message>
    <message>
        <source>Words by language</source>
        <translation>言語ごとの言葉</translation>
    </message>
    <message>
        <source>Another language</source>
        <translation>別の言語</translation>
    </message>
    <message>
        <source>Its tag: de, fr, pt-BR, ...</source>
        <translation>言語タグ：de, fr, pt-BR, ...</translation>
    </message>
    <message>
        <source>Add language</source>
        <translation>言語を追加</translation>
    </message>
    <message>
        <source>Of &quot;%1&quot;</source>
        <translation>「%1」について</translation>
    </message>
    <message>
        <source>Choose a criterion</source>
        <translation>項目を選ぶ</translation>
    </message>
    <message>
        <source>What</source>
        <translation>何の言葉か</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::TextsPage</name>
    <message>
        <source>Short name</source>
        <translation>短い名前</translation>
    </message>
    <message>
        <source>Small letters, digits, &apos;-&apos;</source>
        <translation>英小文字、数字、「-」</translation>
    </message>
    <message>
        <source>Version</source>
        <translation>版</translation>
    </message>
    <message>
        <source>Raise it with each change to be told apart</source>
        <translation>区別が必要な変更のたびに上げます</translation>
    </message>
    <message>
        <source>Title, English</source>
        <translation>題名（英語）</translation>
    </message>
    <message>
        <source>Title, Japanese</source>
        <translation>題名（日本語）</translation>
    </message>
    <message>
        <source>What to do, English</source>
        <translation>指示（英語）</translation>
    </message>
    <message>
        <source>What to do, Japanese</source>
        <translation>指示（日本語）</translation>
    </message>
    <message>
        <source>Another language</source>
        <translation>別の言語</translation>
    </message>
    <message>
        <source>Its tag: de, fr, pt-BR, ...; what is written below is in it</source>
        <translation>言語タグ：de, fr, pt-BR, ...。下の文はその言語で書く</translation>
    </message>
    <message>
        <source>Title, in it</source>
        <translation>その言語の題</translation>
    </message>
    <message>
        <source>What to do, in it</source>
        <translation>その言語の説明</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ToothPage</name>
    <message>
        <source>A tooth of the program</source>
        <translation>プログラムの歯</translation>
    </message>
    <message>
        <source>Tooth</source>
        <translation>歯</translation>
    </message>
    <message>
        <source>FDI number</source>
        <translation>FDI 歯式の番号</translation>
    </message>
    <message>
        <source>Tooth (FDI)</source>
        <translation>歯（FDI）</translation>
    </message>
    <message>
        <source>Patient</source>
        <translation>患者</translation>
    </message>
    <message>
        <source>Another number is another patient; 0 the average</source>
        <translation>番号を変えると別の患者になります。0 は平均</translation>
    </message>
    <message>
        <source>Take this tooth</source>
        <translation>この歯を使う</translation>
    </message>
    <message>
        <source>With all its tissues, landmarks and the mouth around it</source>
        <translation>すべての組織、指標点、周囲の口腔も含みます</translation>
    </message>
    <message>
        <source>A block, for the hand alone</source>
        <translation>手技だけの練習用ブロック</translation>
    </message>
    <message>
        <source>Layers</source>
        <translation>層</translation>
    </message>
    <message>
        <source>As hard as enamel</source>
        <translation>エナメル質の硬さ</translation>
    </message>
    <message>
        <source>Enamel on dentine</source>
        <translation>象牙質の上にエナメル質</translation>
    </message>
    <message>
        <source>With carious dentine</source>
        <translation>う蝕象牙質入り</translation>
    </message>
    <message>
        <source>Take this block</source>
        <translation>このブロックを使う</translation>
    </message>
    <message>
        <source>16 x 12 x 8 mm, with a flat top</source>
        <translation>16 x 12 x 8 mm、上面は平ら</translation>
    </message>
    <message>
        <source>A case of your own</source>
        <translation>自分の症例</translation>
    </message>
    <message>
        <source>Case file...</source>
        <translation>症例のファイル...</translation>
    </message>
    <message>
        <source>A case with landmarks: folder or .handpiece file</source>
        <translation>指標点のある症例：フォルダーまたは .handpiece ファイル</translation>
    </message>
    <message>
        <source>Now: %1, %2 landmarks</source>
        <translation>現在：%1、指標点 %2 個</translation>
    </message>
    <message>
        <source>Now: none</source>
        <translation>現在：なし</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::WorkPage</name>
    <message>
        <source>First bur</source>
        <translation>最初のバー</translation>
    </message>
    <message>
        <source>First drive</source>
        <translation>最初の駆動方式</translation>
    </message>
    <message>
        <source>Its speed</source>
        <translation>回転数</translation>
    </message>
    <message>
        <source>That it is set to at the beginning</source>
        <translation>開始時に設定する回転数</translation>
    </message>
    <message>
        <source> rpm</source>
        <translation> rpm</translation>
    </message>
    <message>
        <source>The student&apos;s choice</source>
        <translation>学生が選ぶ</translation>
    </message>
    <message>
        <source>Burs allowed</source>
        <translation>使えるバー</translation>
    </message>
    <message>
        <source>None ticked: all of them</source>
        <translation>印がなければすべて</translation>
    </message>
    <message>
        <source>Helps that are locked</source>
        <translation>使えない補助機能</translation>
    </message>
    <message>
        <source>At most</source>
        <translation>最長</translation>
    </message>
    <message>
        <source>A time limit</source>
        <translation>制限時間</translation>
    </message>
    <message>
        <source>Minutes</source>
        <translation>分</translation>
    </message>
    <message>
        <source> min</source>
        <translation> 分</translation>
    </message>
    <message>
        <source>Voxel of the tooth</source>
        <translation>歯のボクセル</translation>
    </message>
    <message>
        <source>The same for every student: a score never hangs on their settings</source>
        <translation>どの学生も同じです。学生の設定で得点が変わることはありません</translation>
    </message>
    <message>
        <source>Students judge their own work first</source>
        <translation>学生が先に自己評価する</translation>
    </message>
    <message>
        <source>Before they see the result</source>
        <translation>結果を見る前に行います</translation>
    </message>
    <message>
        <source>Turn the tooth in the window, then take its view</source>
        <translation>ウィンドウで歯を回してから、その視点を取り込みます</translation>
    </message>
    <message>
        <source>The usual view</source>
        <translation>通常の視点</translation>
    </message>
    <message>
        <source>Time</source>
        <translation>時間</translation>
    </message>
    <message>
        <source>Voxel</source>
        <translation>ボクセル</translation>
    </message>
    <message>
        <source>Burs allowed (none ticked: all)</source>
        <translation>使えるバー（印がなければすべて）</translation>
    </message>
    <message>
        <source>Starts with a view of its own.</source>
        <translation>この課題の視点から始まります。</translation>
    </message>
    <message>
        <source>Starts with the usual view.</source>
        <translation>通常の視点から始まります。</translation>
    </message>
    <message>
        <source>Take the window&apos;s view</source>
        <translation>ウィンドウの視点を使う</translation>
    </message>
    <message>
        <source>Take the preparation&apos;s view</source>
        <translation>形成の画像の視点を使う</translation>
    </message>
    <message>
        <source>As the picture on the page Preparation shows it</source>
        <translation>「形成」のページの画像の視点</translation>
    </message>
    <message>
        <source>Show it in the window</source>
        <translation>ウィンドウで見る</translation>
    </message>
    <message>
        <source>Turns the tooth in the window to the start view</source>
        <translation>ウィンドウの歯を開始時の視点にする</translation>
    </message>
    <message>
        <source>Eye</source>
        <translation>視点</translation>
    </message>
    <message>
        <source>Looks at</source>
        <translation>注視点</translation>
    </message>
    <message>
        <source>Up</source>
        <translation>上方向</translation>
    </message>
    <message>
        <source>Start view [mm]</source>
        <translation>開始時の視点 [mm]</translation>
    </message>
    <message>
        <source>Work ends when it is up</source>
        <translation>時間になったら作業を終える</translation>
    </message>
    <message>
        <source>The pedal is dead then; else students are told once, and go on</source>
        <translation>以後フットペダルが効きません。オフの場合は一度知らせるだけで、作業は続けられます</translation>
    </message>
    <message>
        <source>Level</source>
        <translation>レベル</translation>
    </message>
    <message>
        <source>Not said</source>
        <translation>指定なし</translation>
    </message>
    <message>
        <source>Show during the work what is gone of the target</source>
        <translation>作業中に目標の切削量を表示する</translation>
    </message>
    <message>
        <source>A bar for target, leeway and what must stay</source>
        <translation>目標・許容範囲・残すべき部分の切削量をバーで示します</translation>
    </message>
    <message>
        <source>Your own work</source>
        <translation>自分の作業</translation>
    </message>
    <message>
        <source>Choose...</source>
        <translation>選択...</translation>
    </message>
    <message>
        <source>Your recording of this exercise (session.h5), one sitting from the whole tooth to its end, in its voxel: students play it beside their result. It is cut again to prove it; another tooth takes it away.</source>
        <translation>この課題を行った自分の記録。未切削の歯から終わりまで一回で、課題のボクセルで作業したもの。学生は結果の横で再生できます。切削し直して証明します。歯を替えると外れます。</translation>
    </message>
    <message>
        <source>Remove</source>
        <translation>削除</translation>
    </message>
    <message>
        <source>Remove your own work</source>
        <translation>自分の作業を外す</translation>
    </message>
    <message>
        <source>comes along</source>
        <translation>付属する</translation>
    </message>
    <message>
        <source>none</source>
        <translation>なし</translation>
    </message>
    <message>
        <source>comes along: %1</source>
        <translation>付属する（%1）</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::CurveView</name>
    <message>
        <source>Points by value</source>
        <translation>値ごとの得点</translation>
    </message>
    <message>
        <source>Drag a knot. Double click: another one. Right button or Delete: away with it. Arrow keys move it.</source>
        <translation>折れ点をドラッグ。ダブルクリックで追加。右ボタンか Del で削除。矢印キーで移動。</translation>
    </message>
    <message>
        <source>No curve: a double click makes its first knot</source>
        <translation>曲線なし：ダブルクリックで最初の折れ点を作る</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ListTable</name>
    <message>
        <source>Add</source>
        <translation>追加</translation>
    </message>
    <message>
        <source>Remove</source>
        <translation>削除</translation>
    </message>
    <message>
        <source>Up</source>
        <translation>上へ</translation>
    </message>
    <message>
        <source>Down</source>
        <translation>下へ</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::SchoolFeature</name>
    <message>
        <source>School</source>
        <translation>学校</translation>
    </message>
    <message>
        <source>watched by %1</source>
        <translation>%1 が見ています</translation>
    </message>
    <message>
        <source>can be watched</source>
        <translation>見学できる状態</translation>
    </message>
    <message>
        <source>connected</source>
        <translation>接続済み</translation>
    </message>
    <message>
        <source>not reached</source>
        <translation>接続できません</translation>
    </message>
    <message>
        <source>waiting to send %1</source>
        <translation>未送信 %1 件</translation>
    </message>
    <message>
        <source>School: %1</source>
        <translation>学校: %1</translation>
    </message>
    <message>
        <source>Finished work goes to the school by itself. Work that the school gave to do, and practice that you share, can be watched by its teachers.</source>
        <translation>終えた作業は自動的に学校に送られます。学校の課題と、自分で公開した練習は、教員が見ることができます。</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::SchoolLink</name>
    <message>
        <source>The school&apos;s part of the program is not installed (handpiece-school).</source>
        <translation>学校用プログラム（handpiece-school）がインストールされていません。</translation>
    </message>
    <message>
        <source>The school&apos;s part of the program has ended; it begins again with the next tooth.</source>
        <translation>学校用プログラムが終了しました。次に歯を開くと再び始まります。</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ExamBar</name>
    <message>
        <source>Exam</source>
        <translation>試験</translation>
    </message>
    <message>
        <source>Title of the exam</source>
        <translation>試験の名前</translation>
    </message>
    <message>
        <source>What you should know</source>
        <translation>お知らせ</translation>
    </message>
    <message>
        <source>Time left</source>
        <translation>残り時間</translation>
    </message>
    <message>
        <source>Pause</source>
        <translation>休憩</translation>
    </message>
    <message>
        <source>The picture is covered and the pedal is dead until you go on. The minutes for pauses are in the time that is left, which runs on.</source>
        <translation>再開するまで画面が覆われ、ペダルは効きません。残り時間には休憩の分が含まれており、休憩中も進みます。</translation>
    </message>
    <message>
        <source>Open again</source>
        <translation>もう一度開く</translation>
    </message>
    <message>
        <source>The exam&apos;s tooth is not open: bring it back</source>
        <translation>試験の歯が開いていません。もう一度開きます</translation>
    </message>
    <message>
        <source>Hand over...</source>
        <translation>提出...</translation>
    </message>
    <message>
        <source>Hand over</source>
        <translation>提出</translation>
    </message>
    <message>
        <source>Your work is done: it is handed over, and the exam ends</source>
        <translation>作業を終えて提出します。試験は終わります</translation>
    </message>
    <message>
        <source>Go on</source>
        <translation>再開</translation>
    </message>
    <message>
        <source>over by %1</source>
        <translation>%1 超過</translation>
    </message>
    <message>
        <source>The time is over</source>
        <translation>時間が過ぎました</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ExamDialog</name>
    <message>
        <source>%1 min</source>
        <translation>%1 分</translation>
    </message>
    <message>
        <source>%1 %2 s</source>
        <translation>%1 %2 秒</translation>
    </message>
    <message>
        <source>%1 % more time</source>
        <translation>時間延長 %1 %</translation>
    </message>
    <message>
        <source>%1 min for pauses</source>
        <translation>休憩 %1 分</translation>
    </message>
    <message>
        <source>%1 and %2 are in it.</source>
        <translation>%1 と%2を含みます。</translation>
    </message>
    <message>
        <source>%1 is in it.</source>
        <translation>%1 を含みます。</translation>
    </message>
    <message>
        <source>%1 are in it.</source>
        <translation>%1を含みます。</translation>
    </message>
    <message>
        <source>Begin an exam</source>
        <translation>試験を始める</translation>
    </message>
    <message>
        <source>An invigilator is beside you. Type the code on your slip; nothing begins before the invigilator has confirmed who you are.</source>
        <translation>監督者が隣にいることを確かめ、受験票のコードを入力してください。監督者が本人を確認するまで、試験は始まりません。</translation>
    </message>
    <message>
        <source>Candidate&apos;s code</source>
        <translation>受験者コード</translation>
    </message>
    <message>
        <source>Title of the exam</source>
        <translation>試験の名前</translation>
    </message>
    <message>
        <source>What is asked</source>
        <translation>課題</translation>
    </message>
    <message>
        <source>How long it takes</source>
        <translation>試験時間</translation>
    </message>
    <message>
        <source>What is locked</source>
        <translation>使えない機能</translation>
    </message>
    <message>
        <source>Begun before</source>
        <translation>以前の開始</translation>
    </message>
    <message>
        <source>For the invigilator</source>
        <translation>監督者へ</translation>
    </message>
    <message>
        <source>Check who sits here: the slip with this code must be theirs. With your own code and the next code beside this candidate on your sheet you confirm it, and the time begins to run.</source>
        <translation>座っている人が、このコードの受験票の本人であることを確かめてください。監督者自身のコードと、一覧表でこの受験者の横にある次のコードで確認すると、時間が進み始めます。</translation>
    </message>
    <message>
        <source>Opening code</source>
        <translation>開封コード</translation>
    </message>
    <message>
        <source>Invigilator&apos;s code</source>
        <translation>監督者コード</translation>
    </message>
    <message>
        <source>Confirmation code</source>
        <translation>確認コード</translation>
    </message>
    <message>
        <source>What is wrong</source>
        <translation>問題</translation>
    </message>
    <message>
        <source>Back</source>
        <translation>戻る</translation>
    </message>
    <message>
        <source>Back to the candidate&apos;s code</source>
        <translation>受験者コードに戻ります</translation>
    </message>
    <message>
        <source>Go on</source>
        <translation>次へ</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>キャンセル</translation>
    </message>
    <message>
        <source>No exam is begun</source>
        <translation>試験を始めません</translation>
    </message>
    <message>
        <source>Begin the exam</source>
        <translation>試験を開始</translation>
    </message>
    <message>
        <source>Shows which exam it is</source>
        <translation>どの試験かを表示します</translation>
    </message>
    <message>
        <source>The time begins to run</source>
        <translation>時間が進み始めます</translation>
    </message>
    <message>
        <source>Time: %1.</source>
        <translation>試験時間：%1。</translation>
    </message>
    <message>
        <source>No help is locked.</source>
        <translation>使えない機能はありません。</translation>
    </message>
    <message>
        <source>Locked: %1</source>
        <translation>使えない機能：%1</translation>
    </message>
    <message>
        <source>With this code an exam was begun here before: %1 times. This shows.</source>
        <translation>このコードの試験は、ここで以前に %1 回始められています。このことは記録に残ります。</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ExamFeature</name>
    <message>
        <source>Pause</source>
        <translation>休憩</translation>
    </message>
    <message>
        <source>An exam runs.</source>
        <translation>試験中です。</translation>
    </message>
    <message>
        <source>Its time runs on when the window is closed. Start the program again to go on with it.</source>
        <translation>ウィンドウを閉じても時間は進みます。続けるには、プログラムをもう一度起動してください。</translation>
    </message>
    <message>
        <source>Close all the same</source>
        <translation>それでも閉じる</translation>
    </message>
    <message>
        <source>Stay</source>
        <translation>閉じない</translation>
    </message>
    <message>
        <source>Save the receipt</source>
        <translation>受領証を保存</translation>
    </message>
    <message>
        <source>Text (*.txt)</source>
        <translation>テキスト (*.txt)</translation>
    </message>
    <message>
        <source>The station&apos;s exam service does not answer. Go on working, and call the invigilator.</source>
        <translation>この端末の試験サービスが応答しません。作業を続け、監督者を呼んでください。</translation>
    </message>
    <message>
        <source>Your work is not recorded. Call the invigilator.</source>
        <translation>作業が記録されていません。監督者を呼んでください。</translation>
    </message>
    <message>
        <source>Exam</source>
        <translation>試験</translation>
    </message>
    <message>
        <source>Hand your work over?</source>
        <translation>作業を提出しますか。</translation>
    </message>
    <message>
        <source>This ends the exam. Nothing can be changed afterwards.</source>
        <translation>試験はこれで終わります。提出した後は何も変更できません。</translation>
    </message>
    <message>
        <source>Hand over</source>
        <translation>提出</translation>
    </message>
    <message>
        <source>Go on working</source>
        <translation>作業を続ける</translation>
    </message>
    <message>
        <source>The time of this exam is over.</source>
        <translation>試験時間が終わりました。</translation>
    </message>
    <message>
        <source>Hand your work over now. You can still go on, but how late it was handed over is shown to the teacher who decides about the result.</source>
        <translation>いま提出してください。作業は続けられますが、どれだけ遅れて提出したかは、結果を判定する教員に示されます。</translation>
    </message>
    <message>
        <source>Not yet</source>
        <translation>まだ提出しない</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::ReceiptDialog</name>
    <message>
        <source>Receipt</source>
        <translation>受領証</translation>
    </message>
    <message>
        <source>What became of the exam</source>
        <translation>試験の状態</translation>
    </message>
    <message>
        <source>What happens next</source>
        <translation>今後の流れ</translation>
    </message>
    <message>
        <source>The receipt, as it is signed</source>
        <translation>署名された受領証</translation>
    </message>
    <message>
        <source>Save the receipt...</source>
        <translation>受領証を保存...</translation>
    </message>
    <message>
        <source>Save the receipt</source>
        <translation>受領証を保存</translation>
    </message>
    <message>
        <source>Keep it: with it you can show what you handed over and when</source>
        <translation>保管してください。いつ何を提出したかを示せます</translation>
    </message>
    <message>
        <source>Close</source>
        <translation>閉じる</translation>
    </message>
    <message>
        <source>The exam was given up: %1</source>
        <translation>試験は中止されました：%1</translation>
    </message>
    <message>
        <source>Your work has been handed over: %1</source>
        <translation>提出しました：%1</translation>
    </message>
    <message>
        <source>At %1 an invigilator ended it without work.</source>
        <translation>%1 に、監督者が作業なしで終了しました。</translation>
    </message>
    <message>
        <source>At %1. The school&apos;s receipt is not here yet: below stands what this station signed. Your work goes to the school by itself.</source>
        <translation>%1 提出。学校の受領証はまだ届いていません。下は、この端末が署名した控えです。作業は自動で学校に送られます。</translation>
    </message>
    <message>
        <source>At %1. The school has your work; below stands its receipt. A teacher decides about the result.</source>
        <translation>%1 提出。学校に届きました。下が学校の受領証です。結果は教員が判定します。</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::PassRow</name>
    <message>
        <source>One pass goes</source>
        <translation>1回の切削の深さ</translation>
    </message>
    <message>
        <source>Depth of one pass</source>
        <translation>1回の切削の深さ</translation>
    </message>
    <message>
        <source>How deep one stroke cuts: press again to go deeper (Ctrl, Shift and the wheel)</source>
        <translation>1回の切削で削る深さ。もう一度押すとさらに深くなります（Ctrl＋Shift＋ホイール）</translation>
    </message>
    <message>
        <source>Depth of one pass in millimetres</source>
        <translation>1回の切削の深さ（ミリメートル）</translation>
    </message>
    <message>
        <source> mm</source>
        <translation> mm</translation>
    </message>
</context>
<context>
    <name>ExerciseSteps</name>
    <message>
        <source>%1 (%2 %)</source>
        <translation>%1（%2 %）</translation>
    </message>
    <message>
        <source>%1 (due)</source>
        <translation>%1（再確認）</translation>
    </message>
    <message>
        <source>Best so far: %1 %. Attempts: %2</source>
        <translation>これまでの最高点：%1 %。回数：%2</translation>
    </message>
    <message>
        <source>Attempts so far: %1; of none could all be measured.</source>
        <translation>これまでの試行：%1 回。すべてを測定できたものはありません。</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::LiveCard</name>
    <message>
        <source>What will be judged, as it is now</source>
        <translation>採点される項目の現在の値</translation>
    </message>
    <message>
        <source>not to be measured yet</source>
        <translation>まだ測定できません</translation>
    </message>
    <message>
        <source>as it was asked</source>
        <translation>求められる範囲内</translation>
    </message>
    <message>
        <source>less than was asked</source>
        <translation>求められる値より小さい</translation>
    </message>
    <message>
        <source>more than was asked</source>
        <translation>求められる値より大きい</translation>
    </message>
    <message>
        <source>-</source>
        <translation>-</translation>
    </message>
    <message>
        <source>%1: %2 (asked: %3)</source>
        <translation>%1：%2（求められる値：%3）</translation>
    </message>
</context>
<context>
    <name>handpiece::desktop::SectionCard</name>
    <message>
        <source>Section through the place that is shown</source>
        <translation>表示している箇所の断面</translation>
    </message>
    <message>
        <source>Depth: %1, ideal: %2.</source>
        <translation>深さ：%1（理想形：%2）</translation>
    </message>
    <message>
        <source>Depth: %1.</source>
        <translation>深さ：%1</translation>
    </message>
    <message>
        <source>yours</source>
        <translation>自分の形成</translation>
    </message>
    <message>
        <source>ideal</source>
        <translation>理想形</translation>
    </message>
    <message>
        <source>uncut</source>
        <translation>切削前</translation>
    </message>
    <message>
        <source>A square is 1 mm.</source>
        <translation>1 目盛りは 1 mm。</translation>
    </message>
    <message>
        <source>As you finished it.</source>
        <translation>終了時の形成です。</translation>
    </message>
    <message>
        <source>Nothing was to be cut here: %1 deep.</source>
        <translation>ここは削らない所です：深さ %1</translation>
    </message>
</context>
</TS>
